// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/source.h"

#include <filesystem>
#include <utility>

#include "agent/capture/sources.h"
#include "common/base/error.h"
#include "common/base/text.h"
#include "common/dataset/live_topic.h"
#include "common/dataset/recorded_topic.h"
#include "common/dataset/sequence.h"

namespace coslam {

namespace {

// Empty: the path is no list of images.
std::optional<FrameList> listed(const std::filesystem::path& path, double rate_hz) {
  if (std::filesystem::is_directory(path)) return list_folder(path, rate_hz);
  if (path.extension() == ".csv") return list_csv(path);
  if (path.extension() == ".txt") return list_tum(path);
  return std::nullopt;
}

}  // namespace

std::string without_times(const std::string& name, double rate_hz) {
  return name + ": its images have no times, and are taken to come " + format_double(rate_hz) +
         " times a second; rate_hz (--fps of an agent) says another rate";
}

namespace {

bool is_list_or_video(const std::string& uri) {
  return !is_live_uri(uri) && std::filesystem::exists(uri) && !recording::is_recording(uri);
}

std::unique_ptr<ImageSource> open_uncovered(const std::string& uri, const SourceOptions& options) {
  if (uri.starts_with(kRos2Scheme)) return open_ros2(uri, options);
  if (is_live_uri(uri)) return open_live(uri, options);
  if (names_recorded_topic(uri)) return open_recorded(uri, options);
  const std::filesystem::path path = uri;
  if (uri.find("://") != std::string::npos) {
    throw UserError("the source '" + shown_source(uri) +
                    "' is of no known kind: a path, bag:PATH#TOPIC, ros2:/TOPIC, v4l2:N, gst:PIPELINE or rtsp://... is "
                    "expected");
  }
  if (!std::filesystem::exists(path)) throw UserError("there is no source '" + uri + "'");
  if (recording::is_recording(path)) return open_recorded(uri, options);
  if (auto frames = listed(path, options.rate_hz)) {
    if (frames->at_rate && !options.rate_is_given) frames->guesses.push_back(without_times(uri, options.rate_hz));
    return open_list(uri, *frames, options);
  }
  return open_video(path, options);
}

}  // namespace

std::unique_ptr<ImageSource> open_source(const std::string& uri, const SourceOptions& options) {
  auto source = of_one_field(open_uncovered(uri, options), uri);
  return options.covered.empty() ? std::move(source) : covered_at_times(std::move(source), options.covered);
}

std::optional<Image> next_readable(ImageSource& source) {
  auto image = source.next();
  while (image && image->fault != ImageFault::kNone) image = source.next();
  return image;
}

std::optional<ListedTimes> listed_times(const std::string& uri, double rate_hz) {
  if (!is_list_or_video(uri)) return std::nullopt;
  const auto list = listed(uri, rate_hz);
  if (!list) return std::nullopt;
  ListedTimes out{list->all_ns};
  if (out.source_ns.empty()) {
    for (const ListedFrame& frame : list->frames) out.source_ns.emplace_back(frame.source_ns);
  }
  return out;
}

TimeNs written_zero_ns(const std::string& uri, double rate_hz) {
  if (names_recorded_topic(uri) || (!is_live_uri(uri) && recording::is_recording(uri))) return recorded_zero_ns(uri);
  if (!is_list_or_video(uri)) return 0;
  if (const auto list = listed(uri, rate_hz)) return list->zero_ns;
  const auto times = times_beside(uri);
  return times ? read_times(*times).zero_ns : 0;
}

std::filesystem::path first_file(const std::string& uri, double rate_hz) {
  if (!is_list_or_video(uri)) return {};
  const auto frames = listed(uri, rate_hz);
  if (!frames) return uri;
  return frames->frames.empty() ? std::filesystem::path() : frames->frames.front().file;
}

}  // namespace coslam
