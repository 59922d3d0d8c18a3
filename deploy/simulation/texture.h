// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace coslam::sim {

// An image with its half-size reductions, so that a pixel reads what it covers and nothing finer. Values 0 to kMaxValue
// in 16 bits. Coordinates u, v in [0, 1] over the whole image, clamped at the border.
class Texture {
 public:
  static constexpr float kMaxValue = 8.0F;

  Texture() = default;
  // value(column, row) at texel centres; texels at least 1 x 1.
  Texture(int width, int height, const std::function<float(int, int)>& value);

  // Trilinear: footprint in texels of the finest level.
  float sample(float u, float v, float footprint_texels) const;
  int width() const { return levels_.empty() ? 0 : levels_.front().width; }
  int height() const { return levels_.empty() ? 0 : levels_.front().height; }

 private:
  struct Level {
    int width = 0, height = 0;
    std::size_t offset = 0;
  };
  void reduce(const Level& from, const Level& to);
  float bilinear(const Level& level, float u, float v) const;

  std::vector<Level> levels_;
  std::vector<std::uint16_t> texels_;
};

}  // namespace coslam::sim
