// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/noise.h"

#include <algorithm>
#include <cmath>

namespace coslam::sim {
namespace {

std::int32_t floor_int(float x) {
  const auto i = static_cast<std::int32_t>(x);
  return x < static_cast<float>(i) ? i - 1 : i;
}

float fade(float t) { return t * t * t * (t * (t * 6.0F - 15.0F) + 10.0F); }

}  // namespace

float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

float value_noise(float x, float y, std::uint32_t seed) {
  const std::int32_t ix = floor_int(x), iy = floor_int(y);
  const float u = fade(x - static_cast<float>(ix)), v = fade(y - static_cast<float>(iy));
  const float a = unit(hash_cell(ix, iy, seed)), b = unit(hash_cell(ix + 1, iy, seed));
  const float c = unit(hash_cell(ix, iy + 1, seed)), d = unit(hash_cell(ix + 1, iy + 1, seed));
  const float top = a + (b - a) * u, bottom = c + (d - c) * u;
  return 2.0F * (top + (bottom - top) * v) - 1.0F;
}

float fractal_noise(float x, float y, int octaves, std::uint32_t seed) {
  float sum = 0, amplitude = 0.6F;
  for (int i = 0; i < octaves; ++i) {
    sum += amplitude * value_noise(x, y, seed + static_cast<std::uint32_t>(i) * 101U);
    amplitude *= 0.5F;
    // Turned between octaves, so that the grids of the octaves do not line up.
    const float rx = 1.6F * x + 1.2F * y;
    y = -1.2F * x + 1.6F * y + 17.3F;
    x = rx;
  }
  return sum;
}

CellNoise cell_noise(float x, float y, std::uint32_t seed) {
  const std::int32_t ix = floor_int(x), iy = floor_int(y);
  float first = 1e9F, second = 1e9F;
  CellNoise out;
  for (std::int32_t j = iy - 1; j <= iy + 1; ++j) {
    for (std::int32_t i = ix - 1; i <= ix + 1; ++i) {
      const std::uint32_t h = hash_cell(i, j, seed);
      const float dx = static_cast<float>(i) + unit(h) - x;
      const float dy = static_cast<float>(j) + unit(h * 0x9e3779b1U + 7U) - y;
      const float squared = dx * dx + dy * dy;
      if (squared < first) {
        second = first;
        first = squared;
        out.id = h;
      } else if (squared < second) {
        second = squared;
      }
    }
  }
  out.distance = std::sqrt(first);
  out.border = std::sqrt(second) - out.distance;
  return out;
}

}  // namespace coslam::sim
