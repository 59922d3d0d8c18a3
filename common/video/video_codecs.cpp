// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/video/video_codecs.h"

#include <algorithm>
#include <array>
#include <utility>

#include "common/base/error.h"
#include "common/video/pipeline.h"
#include "common/video/plug_in.h"

namespace coslam {
namespace {

const PlugIn& ffmpeg() {
  static const PlugIn loaded =
      load_plug_in(VideoCodecs::kPlugIn, "videos, streams and images other than PNG and JPEG are decoded by FFmpeg");
  return loaded;
}

}  // namespace

const VideoCodecs* video_codecs_if_any() { return static_cast<const VideoCodecs*>(ffmpeg().object); }
const std::string& why_no_video_codecs() { return ffmpeg().why_not; }

const VideoCodecs& video_codecs() {
  if (ffmpeg().object == nullptr) throw UserError(ffmpeg().why_not);
  return *video_codecs_if_any();
}

const Pipelines& pipelines() {
  static const PlugIn loaded = load_plug_in(Pipelines::kPlugIn, "pipelines are played by GStreamer");
  if (loaded.object == nullptr) throw UserError(loaded.why_not);
  return *static_cast<const Pipelines*>(loaded.object);
}

std::unique_ptr<StreamDecoder> StreamDecoder::open(const std::string& url, bool live, std::string* why,
                                                   const std::atomic<bool>* stopped) {
  return video_codecs().open_stream(url, live, why, stopped);
}

std::unique_ptr<VideoPackets> VideoPackets::for_codec(std::string_view codec) {
  constexpr auto kKnown = std::to_array<std::pair<std::string_view, std::string_view>>(
      {{"264", "h264"}, {"265", "hevc"}, {"hevc", "hevc"}, {"vp9", "vp9"}, {"av1", "av1"}});
  const auto* known =
      std::ranges::find_if(kKnown, [&](const auto& names) { return codec.find(names.first) != codec.npos; });
  return known == kKnown.end() ? nullptr : video_codecs().packets_of(known->second);
}

}  // namespace coslam
