// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.h"

namespace coslam {

// A time as it stands in a file or in the name of one, in a unit that is still to be found: whole + billionths / 1e9.
struct WrittenTime {
  std::int64_t whole = 0, billionths = 0;  // 0 to 999999999
  friend auto operator<=>(const WrittenTime&, const WrittenTime&) = default;
};

// `1305031102.175304`, `1700000000123`, `-0.2`, `1.037e-01`; and dates `2011-09-26 13:02:25.964389445` (of a day in
// UTC, in seconds since 1970). Empty for anything else.
std::optional<WrittenTime> parse_written_time(std::string_view text);

// Rates at which cameras take images.
inline constexpr double kSlowest_hz = 0.2, kFastest_hz = 1000;
bool is_rate_of_camera(double rate_hz);

// Interval from an image to the next, in the unit of the ascending times: the median over stretches of a few images of
// their mean. Empty where no two differ.
std::optional<double> usual_interval(const std::vector<WrittenTime>& written);

// A sentence where many images come right after another and then none for long, as over a link that holds them back;
// else empty.
std::string said_of_bursts(const std::string& name, const std::vector<std::optional<TimeNs>>& source_ns);

// The unit that times of a list should be in.
enum class TimeUnit : std::uint8_t { kSeconds, kNanoseconds };

struct SourceTimes {
  std::vector<std::optional<TimeNs>> source_ns;  // times by image; empty: it is left out
  TimeNs zero_ns = 0;                            // zero of source_ns, as it was written
  std::vector<std::string> guesses;              // sentences for the user
};

// Source times of images that come one after another, ascending; empty for an image whose time is that of the one
// before, which is left out. What is guessed is said in `guesses`, with `name` in front:
// - the unit, where in the usual one the images would come more seldom than every 5 s (and are no dates) or more often
// than
//   1000 times a second: the one of s, ms, us, ns in which their rate is most like a camera's;
// - that times are counted from the first image, where they begin later than an hour (as clocks do that count since a
//   machine was started). Dates are counted from the first without a word;
// - that images in bursts are spread evenly, where most come right after another;
// - that nothing comes for a minute and more, far longer than usual;
// - that images before 0 are not played.
// Throws UserError where no unit makes a rate of them, or more than half repeat the time of the one before.
SourceTimes source_times(const std::string& name, const std::vector<WrittenTime>& written, TimeUnit usual);

}  // namespace coslam
