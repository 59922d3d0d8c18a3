// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/agent_loop.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "agent/agent_report.h"
#include "agent/thumbnail.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/flow/clock.h"

namespace coslam {
namespace {

constexpr auto kServerPatience = std::chrono::seconds(5);
constexpr auto kStatusPeriod = std::chrono::seconds(1);

}  // namespace

AgentLoop::AgentLoop(AgentLink& link, std::unique_ptr<Feed> feed, const Hello& hello, const AgentConfig& config)
    : AgentLoop(link, std::move(feed), hello, config, make_feature_tracker(hello.camera, config)) {}

AgentLoop::AgentLoop(AgentLink& link, std::unique_ptr<Feed> feed, const Hello& hello, const AgentConfig& config,
                     std::unique_ptr<FeatureTracker> tracker, Clock now)
    : link_(link),
      feed_(std::move(feed)),
      hello_(hello),
      agent_(hello.agent, hello.agent_run, hello.camera, config, std::move(tracker)),
      now_(std::move(now)),
      governor_(hello.rate_hz),
      gives_thumbnails_(config.thumbnails) {
  if (hello.pacing == Pacing::kLive) describer_.emplace();
}

bool AgentLoop::step(const std::atomic<bool>& stop) {
  const std::optional<Image> image = feed_->next(stop);
  if (!image) return false;
  judge(*image);
  answer_who_looks(*image);
  if (image->fault != ImageFault::kNone) {
    tell_state();
    return true;
  }
  ++frames_;
  agent_.track(*image);
  const std::vector<MapPatch> patches = collect_patches(stop);
  if (hello_.pacing == Pacing::kLockstep && (stop || server_stops())) return false;
  if (stamps_are_utc_ && !patches.empty()) exchange_ = {patches.back().sent_ns, patches.back().received_ns};
  if (adapts_) link_.limit_replies(governor_.heard(patches, link_.waiting().any(), link_.server_alive(), now_()));
  const bool sends = !adapts_ || governor_.due(image->capture_ns);
  if (sends) take_described();
  AgentOutput out = agent_.finish(patches, sends ? answers() : Answers::none());
  out.frame.narrow_link = governor_.narrow();
  out.frame.images_doubted = verdict_.verdict() != ImageFault::kNone;
  out.frame.clock_set_ns = clock_set_ns_;
  if (!sends) {
    not_sent_ = std::move(out.frame);
  } else {
    not_sent_.reset();
    last_sent_ = out.frame.frame;
    const double delay_s =
        image->available_since ? std::chrono::duration<double>(now_() - *image->available_since).count() : 0;
    if (out.describe) describer_->start(std::move(out.describe));
    if (!out.descriptors) out.descriptors = std::exchange(described_, std::nullopt);
    link_.send(std::move(out.frame), out.patches, out.descriptors);
    ++sent_frames_;
    governor_.sent(image->frame, now_(), delay_s, link_.waiting().sent_bytes);
  }
  warn_when_slow();
  tell_state();
  return true;
}

void AgentLoop::judge(const Image& image) {
  // Stamps may be of any clock.
  const TimeNs now_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now_().time_since_epoch()).count();
  verdict_.note(image.fault, hello_.pacing == Pacing::kLive ? now_ns : image.capture_ns);
  if (image.fault != ImageFault::kNone && image.fault != ImageFault::kMissing) {
    ++left_out_[static_cast<std::size_t>(image.fault)];
  }
  pattern_stays_ |= image.pattern_stays;
  const bool stands = verdict_.verdict() != ImageFault::kNone;
  if (image.fault == ImageFault::kRepeated && !stands) ++repeated_;
  if (stamps_are_utc_) clock_set_ns_ = coslam::clock_set_ns();
}

// Images that are not to be believed are those that people want to see.
void AgentLoop::answer_who_looks(const Image& image) {
  constexpr std::chrono::milliseconds kPeriod{900}, kNarrowPeriod{10'000};
  if (image.grey.empty() || !link_.take_thumbnail_request()) return;
  const auto now = now_();
  if (last_thumbnail_ && now - *last_thumbnail_ < (governor_.narrow() ? kNarrowPeriod : kPeriod)) return;
  last_thumbnail_ = now;
  Thumbnail thumbnail{hello_.agent, hello_.agent_run, image.capture_ns, {}};
  if (gives_thumbnails_) thumbnail.jpeg = thumbnail_jpeg(image.grey);
  link_.send(thumbnail);
}

// To the log and, when something changed or a second is over, to the server.
void AgentLoop::tell_state() {
  if (logs_as_) say_state();
  const auto now = now_();
  const bool changed = agent_.pose_state() != last_pose_state_ || verdict_.verdict() != last_verdict_;
  if (last_status_ && now - *last_status_ <= kStatusPeriod && !changed) return;
  last_status_ = now;
  last_pose_state_ = agent_.pose_state();
  last_verdict_ = verdict_.verdict();
  throw_if_refused();
  link_.send(status(AgentState::kRunning));
}

// New answers wait for the old ones.
Answers AgentLoop::answers() const {
  Answers out = Answers::all();
  out.later = describer_.has_value();
  if (adapts_) {
    const LinkGovernor::Room room = governor_.room();
    out.patches = room.patches.value_or(out.patches);
    out.described = room.features.value_or(out.described);
    const RepliesWaiting waiting = link_.waiting();
    if (waiting.patches) out.patches = 0;
    if (waiting.descriptors) out.described = 0;
  }
  if (describing()) out.described = 0;
  return out;
}

void AgentLoop::take_described() {
  auto done = describer_ ? describer_->take() : std::optional<Describer::Described>();
  if (!done) return;
  times_.add("describe", done->took);
  described_ = agent_.take(done->end);
}

void AgentLoop::say(const std::string& text) const {
  log_info(logs_as_ == LogsAs::kOneOfSeveral ? "agent " + hello_.agent + ": " + text : text);
}

void AgentLoop::warn(const std::string& text) const {
  log_warn(logs_as_ == LogsAs::kOneOfSeveral ? "agent " + hello_.agent + ": " + text : text);
}

void AgentLoop::warn_when_slow() {
  constexpr std::uint32_t kFramesToTell = 60;
  if (hello_.pacing != Pacing::kLive || frames_ != kFramesToTell) return;
  const double taken_ms = mean_frame_ms(agent_), period_ms = 1000 / hello_.rate_hz;
  if (taken_ms <= period_ms) return;
  warn("a frame of " + std::to_string(hello_.camera.width_px) + "x" + std::to_string(hello_.camera.height_px) +
       " pixels takes " + std::to_string(std::lround(taken_ms)) + " ms, but the next comes after " +
       std::to_string(std::lround(period_ms)) +
       ": images are dropped; track them smaller (agent.tracker.most_width_px), or fewer points "
       "(agent.tracker.max_tracks)" +
       (stamps_are_utc_ ? "" : "; with --rate max nothing is dropped"));
}

void AgentLoop::say_state() {
  if (const auto word = words_.server(link_.server_alive(), now_())) say(*word);
  if (const auto word = words_.link(!adapts_ || !governor_.thins_frames(), now_())) say(*word);
  if (const auto word = words_.pose(agent_.pose_state(), now_())) say(*word);
  if (const auto word = words_.working_width(agent_.working_width_px())) say(*word);
  if (const auto word = words_.own_body(agent_.own_body_share())) warn(*word);
  // Where the server says it in the same log, once is enough.
  if (const auto word = words_.images(verdict_.verdict()); word && logs_as_ == LogsAs::kProcess) {
    verdict_.verdict() == ImageFault::kNone ? say(*word) : warn(*word);
  }
  if (const auto word = words_.alternating(left_out_[static_cast<std::size_t>(ImageFault::kAlternating)] > 0)) {
    warn(*word);
  }
  if (const auto word = words_.repeating(repeated_, frames_)) warn(*word);
  if (const auto word = words_.fixed_pattern(pattern_stays_)) warn(*word);
  if (const auto word = words_.clock(clock_set_ns_)) warn(*word);
  if (const auto word = words_.readout(agent_.found_readout_s())) say(*word);
}

std::vector<MapPatch> AgentLoop::collect_patches(const std::atomic<bool>& stop) {
  if (hello_.pacing == Pacing::kLive) return link_.take_patches();
  std::vector<MapPatch> patches;
  if (!last_sent_) return patches;
  const auto give_up = now_() + kServerPatience;
  while (!stop) {
    std::optional<MapPatch> patch = link_.wait_patch(*last_sent_, std::chrono::milliseconds(200));
    if (patch) {
      const bool answered = patch->after_frame >= *last_sent_;
      patches.push_back(std::move(*patch));
      if (answered) return patches;
      continue;
    }
    if (server_stops()) return patches;
    throw_if_refused();
    if (now_() > give_up && !link_.server_alive()) {
      throw UserError("the map server no longer answers; a replay at full speed cannot go on without it");
    }
  }
  return patches;
}

bool AgentLoop::server_stops() const {
  const auto server = link_.server_status();
  return hello_.pacing == Pacing::kLockstep && server && server->stopping;
}

void AgentLoop::throw_if_refused() const {
  const auto server = link_.server_status();
  if (!server) return;
  if (const auto reason = refusal_of(*server, hello_.agent_run)) throw UserError(*reason);
}

std::uint32_t AgentLoop::left_out() const { return std::accumulate(left_out_.begin(), left_out_.end(), 0U); }

AgentStatus AgentLoop::status(AgentState state) const {
  AgentStatus s;
  s.agent = hello_.agent;
  s.agent_run = hello_.agent_run;
  s.state = state;
  s.pose_state = agent_.pose_state();
  s.frames = sent_frames_;
  s.dropped = not_sent();
  s.left_out = left_out();
  s.image_fault = verdict_.verdict();
  s.tracks = static_cast<std::uint32_t>(agent_.tracks());
  s.frame_ms = static_cast<float>(mean_frame_ms(agent_));
  s.exchange = exchange_;
  s.exchange.replied_ns = utc_now_ns();
  return s;
}

std::string AgentLoop::report() const {
  return agent_report(agent_, times_,
                      {.start_s = start_s_,
                       .images = sent_frames_ + not_sent() + left_out(),
                       .left_out = left_out_,
                       .with_warnings = logs_as_ == LogsAs::kProcess});
}

// Where a run ends, places are often seen again that it began with, and nobody can ask for this image any more.
std::optional<DescriptorReply> AgentLoop::last_image() {
  const std::optional<FrameId> newest = governor_.newest_sent();
  const bool known = newest && agent_.described() == *newest;
  if (known && !describing() && !link_.waiting().descriptors) return std::nullopt;
  return agent_.describe_last();
}

void AgentLoop::finish(const std::atomic<bool>& stop) {
  // In lock-step the answer to the last frame is still to come; without it the server may not have used that frame.
  try {
    if (hello_.pacing == Pacing::kLockstep && link_.server_alive()) collect_patches(stop);
  } catch (const UserError&) {
    // It is gone: there is nobody to report to either.
  }
  // The server is to have the image that it is told about.
  if (not_sent_) {
    link_.send(std::move(*std::exchange(not_sent_, std::nullopt)), {}, {});
    ++sent_frames_;
  }
  AgentStatus last = status(AgentState::kFinished);
  last.report_json = report();
  last.last_image = last_image();
  link_.send(last);
}

}  // namespace coslam
