// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string_view>

namespace coslam {

// A video of which each packet comes by itself, as topics of recordings have it. Frames have to come in the order in
// which they were taken, as they do without B frames.
class VideoPackets {
 public:
  // Creates a parser by the name of a codec ("h264", "libx264", "h265", "hevc", "vp9", "av1"); null: unknown name.
  static std::unique_ptr<VideoPackets> for_codec(std::string_view codec);
  ~VideoPackets();
  VideoPackets(const VideoPackets&) = delete;
  VideoPackets& operator=(const VideoPackets&) = delete;

  // The luma of the packet's frame, CV_8UC1 or CV_16UC1; empty where the packet alone makes none, as before the first
  // key frame.
  cv::Mat decode(std::span<const std::uint8_t> packet);

 private:
  struct Impl;
  explicit VideoPackets(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace coslam
