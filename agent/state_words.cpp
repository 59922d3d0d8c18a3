// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/state_words.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace coslam {
namespace {

constexpr std::chrono::milliseconds kPasses{500};

}  // namespace

std::optional<std::string> StateWords::Presence::note(bool present, Instant now) {
  if (present) {
    const std::optional<Instant> absent_since = std::exchange(gone_since_, std::nullopt);
    const bool first = !std::exchange(was_there_, true);
    if (first && first_ != nullptr) return first_;
    if (!std::exchange(said_lost_, false)) return std::nullopt;
    char text[96];
    std::snprintf(text, sizeof text, "%s after %.1f s", back_,
                  std::chrono::duration<double>(now - *absent_since).count());
    return text;
  }
  if (!was_there_ || said_lost_) return std::nullopt;
  if (!gone_since_) gone_since_ = now;
  if (now - *gone_since_ < kPasses) return std::nullopt;
  said_lost_ = true;
  return lost_;
}

std::optional<std::string> StateWords::images(ImageFault verdict) {
  if (std::exchange(said_fault_, verdict) == verdict) return std::nullopt;
  if (verdict == ImageFault::kNone) return "its images are to be believed again";
  return "its images are not to be believed: " + std::string(words_of(verdict).why);
}

std::optional<std::string> StateWords::alternating(bool left_out_some) {
  if (!left_out_some || std::exchange(said_alternating_, true)) return std::nullopt;
  return "its images are taken in turn at several settings, as exposures that are bracketed, dots that are projected "
         "into some of them, or two cameras in one stream: those of one setting are used, the others left out; take "
         "all "
         "at one";
}

std::optional<std::string> StateWords::repeating(std::uint32_t repeats, std::uint32_t fresh_images) {
  constexpr std::uint32_t kSome = 10, kOneIn = 7;
  if (said_repeating_ || repeats < kSome || kOneIn * repeats < repeats + fresh_images) return std::nullopt;
  said_repeating_ = true;
  return "many of its images are the one before once more, as of a stream with a higher rate than its camera: they are "
         "left out";
}

std::optional<std::string> StateWords::fixed_pattern(bool found) {
  if (!found || std::exchange(said_pattern_, true)) return std::nullopt;
  return "a pattern stays in its picture wherever it looks, as dots that are projected along with it (switch the "
         "emitter "
         "off), dirt on the lens or a grid drawn over it: what is followed of it does not move, and the map suffers";
}

std::optional<std::string> StateWords::own_body(double share) {
  constexpr double kMore = 1.25;
  if (share <= kMore * said_body_) return std::nullopt;
  said_body_ = share;
  char text[200];
  std::snprintf(text, sizeof text,
                "%.0f %% of its picture moves with the camera (a body, a mount, text?) and is left out; a mask says it "
                "from the first image on",
                100 * share);
  return text;
}

std::optional<std::string> StateWords::clock(TimeNs set_ns) {
  constexpr TimeNs kNoise_ns = 10'000'000;
  const TimeNs by_ns = set_ns - said_set_ns_;
  if (std::abs(by_ns) < kNoise_ns) return std::nullopt;
  said_set_ns_ = set_ns;
  char text[160];
  std::snprintf(text, sizeof text, "the time of day was set %s by %.3f s; stamps go on without a jump",
                by_ns < 0 ? "back" : "forward", std::abs(to_seconds(by_ns)));
  return text;
}

std::optional<std::string> StateWords::working_width(int width_px) {
  const int said_px = std::exchange(said_width_px_, width_px);
  if (width_px == said_px || said_px == 0) return std::nullopt;
  const char* why = width_px < said_px
                        ? "its images are dim, noisy or soft, and hold no detail that half of their width would lose"
                        : "its images hold fine detail again";
  return std::string(why) + ": tracked at a width of " + std::to_string(width_px) + " pixels instead of " +
         std::to_string(said_px);
}

std::optional<std::string> StateWords::readout(double readout_s) {
  constexpr double kDifferent = 0.33;
  if (std::abs(readout_s - said_readout_s_) <= kDifferent * said_readout_s_) return std::nullopt;
  said_readout_s_ = readout_s;
  if (readout_s <= 0) return "its images do not look like those of a rolling shutter any more";
  char text[160];
  std::snprintf(text, sizeof text,
                "a rolling shutter: the rows of an image are read over about %.0f ms, which is made up for; "
                "agent.readout_s sets it",
                1e3 * readout_s);
  return text;
}

}  // namespace coslam
