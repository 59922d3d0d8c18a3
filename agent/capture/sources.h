// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "agent/capture/frame_list.h"
#include "agent/capture/source.h"

// The kinds of source behind open_source().
namespace coslam {

// `name` is what the user called the source.
std::unique_ptr<ImageSource> open_list(const std::string& name, FrameList list, const SourceOptions& options);
std::unique_ptr<ImageSource> open_video(const std::filesystem::path& file, const SourceOptions& options);
// bag:PATH#TOPIC, or a path.
std::unique_ptr<ImageSource> open_recorded(const std::string& uri, const SourceOptions& options);
// Zero of a recording's times, where that is not within an hour of 0.
TimeNs recorded_zero_ns(const std::string& uri);
// ros2:/TOPIC, see live_topic.h.
std::unique_ptr<ImageSource> open_ros2(const std::string& uri, const SourceOptions& options);
std::unique_ptr<ImageSource> open_live(const std::string& uri, const SourceOptions& options);
// Warning about images that come at an unknown rate.
std::string without_times(const std::string& name, double rate_hz);
// Turns interlaced images into images of one field; `name` as the user called the source.
std::unique_ptr<ImageSource> of_one_field(std::unique_ptr<ImageSource> source, std::string name);
std::unique_ptr<ImageSource> covered_at_times(std::unique_ptr<ImageSource> source, std::vector<TimeSpan> covered);
// Whether the source plays from now on, of any kind.
bool is_live_uri(const std::string& uri);

// Whether a source time is played, and as what.
class PlayedSpan {
 public:
  explicit PlayedSpan(const SourceOptions& options)
      : start_ns_(to_ns(options.start_s)),
        end_ns_(options.duration_s ? std::optional(start_ns_ + to_ns(*options.duration_s)) : std::nullopt) {}
  bool before(TimeNs source_ns) const { return source_ns < start_ns_; }
  bool after(TimeNs source_ns) const { return end_ns_ && source_ns >= *end_ns_; }
  TimeNs played_ns(TimeNs source_ns) const { return source_ns - start_ns_; }

 private:
  TimeNs start_ns_;
  std::optional<TimeNs> end_ns_;
};

}  // namespace coslam
