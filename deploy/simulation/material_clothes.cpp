// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "deploy/simulation/material.h"
#include "deploy/simulation/noise.h"

namespace coslam::sim {
namespace {

float weave(const SurfacePoint& p, std::uint32_t seed) {
  const float threads = 0.06F * std::sin(p.u_m * 900.0F) * std::sin(p.v_m * 900.0F);
  const float folds = 0.20F * fractal_noise(p.u_m * 7.0F, p.v_m * 4.0F, 4, seed + 51U);
  return 1.0F + threads + folds;
}

// 1 inside a line of the given width at the middle of each period, each line as wide as its number says.
float lines(float x, float period_m, float width_m, std::uint32_t seed) {
  const float number = std::floor(x / period_m);
  const float drawn = unit(hash_cell(static_cast<int>(number), 0, seed));
  const float off = std::abs(x - (number + 0.5F) * period_m), half = 0.5F * width_m * (0.5F + drawn);
  return (1.0F - smooth_step(half * 0.9F, half * 1.1F, off)) * (0.35F + 0.65F * drawn);
}

// Small marks of several forms, one in most cells.
float motifs(const SurfacePoint& p, float cell_m, std::uint32_t seed) {
  const float x = p.u_m / cell_m, y = p.v_m / cell_m;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  const std::uint32_t id = hash_cell(column, row, seed);
  const float dx = x - static_cast<float>(column) - 0.35F - 0.3F * unit(id * 3U + 1U);
  const float dy = y - static_cast<float>(row) - 0.35F - 0.3F * unit(id * 5U + 1U);
  const float size = 0.14F + 0.18F * unit(id * 7U + 1U);
  float distance = std::max(std::abs(dx), std::abs(dy));
  if (id % 3U == 1) distance = std::hypot(dx, dy);
  if (id % 3U == 2) distance = std::abs(dx) + std::abs(dy);
  if (unit(id * 11U + 1U) > 0.8F) return 0;
  return 1.0F - smooth_step(size - 0.04F, size + 0.04F, distance);
}

}  // namespace

float checked_cloth_albedo(const Material& m, const SurfacePoint& p) {
  constexpr float kPeriodM = 0.055F;
  const float across = lines(p.u_m, kPeriodM, 0.026F, m.seed), along = lines(p.v_m, kPeriodM, 0.026F, m.seed + 1U);
  const float thin = std::max(lines(p.u_m + 0.02F, kPeriodM, 0.006F, m.seed + 2U),
                              lines(p.v_m + 0.02F, kPeriodM, 0.006F, m.seed + 3U));
  float value = m.tone * (1.25F - 0.55F * across - 0.55F * along);
  value += (0.85F - value) * 0.7F * thin;
  value += (0.06F - value) * 0.8F * motifs(p, 0.085F, m.seed + 4U);
  return value * weave(p, m.seed);
}

float printed_cloth_albedo(const Material& m, const SurfacePoint& p) {
  const float bend = 0.35F * fractal_noise(p.u_m * 30.0F, p.v_m * 30.0F, 2, m.seed + 1U);
  const CellNoise blotch = cell_noise(p.u_m / 0.06F + bend, p.v_m / 0.06F - bend, m.seed);
  const float tone = unit(blotch.id * 13U + 5U);
  float value = 0.08F + 0.85F * m.tone * (0.2F + 1.3F * tone * tone);
  const float flower = 1.0F - smooth_step(0.16F, 0.24F, blotch.distance);
  value += ((tone > 0.5F ? 0.06F : 0.85F) - value) * flower;
  return value * weave(p, m.seed);
}

float striped_cloth_albedo(const Material& m, const SurfacePoint& p) {
  const float bands = lines(p.v_m, 0.06F, 0.045F, m.seed), seams = lines(p.v_m + 0.03F, 0.06F, 0.008F, m.seed + 1U);
  float value = m.tone * (1.3F - 1.1F * bands);
  value += (0.85F - value) * 0.6F * seams;
  const float mark = motifs(p, 0.07F, m.seed + 2U);
  value += ((value > 0.3F ? 0.05F : 0.8F) - value) * mark;
  return value * weave(p, m.seed);
}

float denim_albedo(const Material& m, const SurfacePoint& p) {
  const float washed = fractal_noise(p.u_m * 9.0F, p.v_m * 5.0F, 5, m.seed);
  const float twill = 0.10F * std::sin((p.u_m + p.v_m) * 800.0F);
  float value = m.tone * (1.0F + 0.55F * washed + twill);
  const CellNoise worn = cell_noise(p.u_m / 0.09F, p.v_m / 0.09F, m.seed + 1U);
  const float ragged = worn.distance + 0.25F * value_noise(p.u_m * 60.0F, p.v_m * 60.0F, m.seed + 2U);
  if (unit(worn.id * 7U + 1U) < 0.75F) {
    const float spot = 1.0F - smooth_step(0.2F, 0.3F, ragged);
    value += ((unit(worn.id) < 0.6F ? 0.75F : 0.05F) - value) * spot;
  }
  const float seam = std::min(std::abs(p.u_m - 0.25F * p.width_m), std::abs(p.u_m - 0.75F * p.width_m));
  if (seam < 0.006F && std::fmod(p.v_m, 0.02F) < 0.012F) value = 0.7F;
  return value;
}

float face_albedo(const Material& m, const SurfacePoint& p) {
  // Around from the front over the left; v from the top of the head to the collar.
  const float u = p.u_m / p.width_m, y = p.v_m / p.height_m;
  const float side = u > 0.5F ? u - 1.0F : u;  // 0 in front, +-0.5 behind
  const float dx = side * p.width_m, dy = p.v_m;
  const float strands = fractal_noise(p.u_m * 70.0F, p.v_m * 14.0F, 3, m.seed);
  const float hair_line =
      0.24F + 0.32F * smooth_step(0.12F, 0.24F, std::abs(side)) + 0.05F * value_noise(p.u_m * 45.0F, 0.0F, m.seed + 1U);
  if (y < hair_line) {
    const CellNoise lock = cell_noise(p.u_m / 0.04F, p.v_m / 0.05F, m.seed + 2U);
    return (0.08F + 0.28F * unit(lock.id)) * (1.0F + 0.6F * strands);
  }
  float value = m.tone * (1.0F + 0.15F * fractal_noise(p.u_m * 25.0F, p.v_m * 25.0F, 4, m.seed + 3U));
  const float eye_v = 0.40F * p.height_m, mouth_v = 0.60F * p.height_m;
  const float eye_x = std::abs(dx) - 0.035F;
  if (std::hypot(eye_x, 1.6F * (dy - eye_v)) < 0.016F) value = std::abs(eye_x) < 0.007F ? 0.03F : 0.8F;
  if (std::abs(eye_x) < 0.02F && std::abs(dy - eye_v + 0.02F) < 0.004F) value = 0.08F;
  if (std::abs(dx) < 0.012F && std::abs(dy - 0.51F * p.height_m) < 0.006F) value *= 0.55F;
  if (std::abs(dx) < 0.027F && std::abs(dy - mouth_v) < 0.006F) value = 0.15F;
  if (std::hypot(std::abs(side) - 0.25F, 0.6F * (y - 0.48F)) < 0.03F) value *= 0.6F;  // ears
  return value;
}

float hand_albedo(const Material& m, const SurfacePoint& p) {
  const float finger = std::fmod(p.u_m, 0.02F) < 0.003F && p.v_m > 0.55F * p.height_m ? 0.55F : 1.0F;
  return m.tone * finger * (1.0F + 0.25F * fractal_noise(p.u_m * 40.0F, p.v_m * 40.0F, 4, m.seed));
}

float shoe_albedo(const Material& m, const SurfacePoint& p) {
  float value = m.tone * (1.0F + 0.3F * fractal_noise(p.u_m * 30.0F, p.v_m * 30.0F, 4, m.seed));
  const float below = std::abs(p.u_m / p.width_m - 0.5F);  // 0.5 is the middle of the sole
  if (below > 0.34F) value = 0.12F;
  if (std::abs(below - 0.33F) < 0.015F) value = 0.8F;
  if (below < 0.1F && p.v_m > 0.06F && p.v_m < 0.16F && std::fmod(p.v_m, 0.02F) < 0.007F) value = 0.85F;  // laces
  return value;
}

}  // namespace coslam::sim
