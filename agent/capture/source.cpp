// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/source.h"

#include <filesystem>
#include <utility>

#include "agent/capture/sources.h"
#include "common/base/error.h"
#include "common/dataset/recorded_topic.h"

namespace coslam {

namespace {

std::unique_ptr<ImageSource> open_uncovered(const std::string& uri, const SourceOptions& options) {
  if (is_live_uri(uri)) return open_live(uri, options);
  if (uri.starts_with(kMcapScheme)) return open_mcap(uri, options);
  const std::filesystem::path path = uri;
  if (uri.find("://") != std::string::npos) {
    throw UserError("the source '" + uri +
                    "' is of no known kind: a path, mcap:FILE#TOPIC, v4l2:N, gst:PIPELINE or rtsp://... is expected");
  }
  if (!std::filesystem::exists(path)) throw UserError("there is no source '" + uri + "'");
  if (std::filesystem::is_directory(path)) return open_list(uri, list_folder(path, options.rate_hz), options);
  if (path.extension() == ".csv") return open_list(uri, list_csv(path), options);
  if (path.extension() == ".txt") return open_list(uri, list_tum(path), options);
  return open_video(path, options);
}

}  // namespace

std::unique_ptr<ImageSource> open_source(const std::string& uri, const SourceOptions& options) {
  auto source = open_uncovered(uri, options);
  return options.covered.empty() ? std::move(source) : covered_at_times(std::move(source), options.covered);
}

}  // namespace coslam
