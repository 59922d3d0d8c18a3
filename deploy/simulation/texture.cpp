// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/texture.h"

#include <algorithm>
#include <cmath>

namespace coslam::sim {
namespace {

constexpr float kSteps = 65535.0F;

}  // namespace

Texture::Texture(int width, int height, const std::function<float(int, int)>& value) {
  std::size_t total = 0;
  for (int w = width, h = height;; w = std::max(1, w / 2), h = std::max(1, h / 2)) {
    levels_.push_back({w, h, total});
    total += static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
    if (w == 1 && h == 1) break;
  }
  texels_.resize(total);
  std::uint16_t* out = texels_.data();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float clamped = std::clamp(value(x, y) / kMaxValue, 0.0F, 1.0F);
      *out++ = static_cast<std::uint16_t>(clamped * kSteps + 0.5F);
    }
  }
  for (std::size_t i = 1; i < levels_.size(); ++i) reduce(levels_[i - 1], levels_[i]);
}

void Texture::reduce(const Level& from, const Level& to) {
  // Areas, not pairs: an odd size would shift the picture by half a texel a level.
  const float scale_x = static_cast<float>(from.width) / static_cast<float>(to.width);
  const float scale_y = static_cast<float>(from.height) / static_cast<float>(to.height);
  const auto overlap = [](int texel, float low, float high) {
    const auto t = static_cast<float>(texel);
    return std::max(0.0F, std::min(high, t + 1.0F) - std::max(low, t));
  };
  for (int y = 0; y < to.height; ++y) {
    const float y0 = static_cast<float>(y) * scale_y, y1 = y0 + scale_y;
    for (int x = 0; x < to.width; ++x) {
      const float x0 = static_cast<float>(x) * scale_x, x1 = x0 + scale_x;
      float sum = 0, weights = 0;
      for (int j = static_cast<int>(y0); j < from.height && static_cast<float>(j) < y1; ++j) {
        for (int i = static_cast<int>(x0); i < from.width && static_cast<float>(i) < x1; ++i) {
          const float weight = overlap(i, x0, x1) * overlap(j, y0, y1);
          sum += weight * texels_[from.offset + static_cast<std::size_t>(j * from.width + i)];
          weights += weight;
        }
      }
      texels_[to.offset + static_cast<std::size_t>(y * to.width + x)] =
          static_cast<std::uint16_t>(sum / weights + 0.5F);
    }
  }
}

float Texture::bilinear(const Level& level, float u, float v) const {
  const auto width = static_cast<float>(level.width), height = static_cast<float>(level.height);
  const float x = std::clamp(u * width - 0.5F, 0.0F, width - 1.0F);
  const float y = std::clamp(v * height - 0.5F, 0.0F, height - 1.0F);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int right = x0 + 1 < level.width ? 1 : 0, down = y0 + 1 < level.height ? level.width : 0;
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const std::uint16_t* p = texels_.data() + level.offset + static_cast<std::size_t>(y0 * level.width + x0);
  const float top = static_cast<float>(p[0]) + fx * static_cast<float>(p[right] - p[0]);
  const float bottom = static_cast<float>(p[down]) + fx * static_cast<float>(p[down + right] - p[down]);
  return (top + fy * (bottom - top)) * (kMaxValue / kSteps);
}

float Texture::sample(float u, float v, float footprint_texels) const {
  const float level = std::log2(std::max(footprint_texels, 1.0F));
  const std::size_t last = levels_.size() - 1;
  const auto lower = std::min(static_cast<std::size_t>(level), last);
  const float fine = bilinear(levels_[lower], u, v);
  const float blend = level - static_cast<float>(lower);
  if (lower == last || blend < 0.02F) return fine;
  return fine + std::min(blend, 1.0F) * (bilinear(levels_[lower + 1], u, v) - fine);
}

}  // namespace coslam::sim
