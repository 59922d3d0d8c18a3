// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "common/video/picture.h"

namespace coslam {

// A video of which each packet comes by itself, as topics of recordings have it. Frames have to come in the order in
// which they were taken, as they do without B frames.
class VideoPackets {
 public:
  // Creates a parser by the name of a codec ("h264", "libx264", "h265", "hevc", "vp9", "av1"); null: unknown name.
  // Throws UserError where videos cannot be decoded here.
  static std::unique_ptr<VideoPackets> for_codec(std::string_view codec);
  virtual ~VideoPackets() = default;

  // The luma of the packet's frame; empty where the packet alone makes none, as before the first key frame.
  virtual Picture decode(std::span<const std::uint8_t> packet) = 0;
};

}  // namespace coslam
