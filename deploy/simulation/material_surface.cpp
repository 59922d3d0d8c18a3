// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "deploy/simulation/material.h"
#include "deploy/simulation/noise.h"

namespace coslam::sim {
namespace {

// Where a point lies in a wall or floor of laid pieces: the piece's indices, and the distance to its nearest edge.
struct Laid {
  int column = 0, row = 0;
  float in_u_m = 0, in_v_m = 0;
  float edge_m = 0;
  std::uint32_t id = 0;
};

Laid lay(float u, float v, float piece_u_m, float piece_v_m, float shift_per_row, std::uint32_t seed) {
  Laid out;
  out.row = static_cast<int>(std::floor(v / piece_v_m));
  const float shift = shift_per_row * piece_u_m * static_cast<float>(out.row);
  out.column = static_cast<int>(std::floor((u + shift) / piece_u_m));
  out.in_u_m = u + shift - static_cast<float>(out.column) * piece_u_m;
  out.in_v_m = v - static_cast<float>(out.row) * piece_v_m;
  out.edge_m = std::min({out.in_u_m, piece_u_m - out.in_u_m, out.in_v_m, piece_v_m - out.in_v_m});
  out.id = hash_cell(out.column, out.row, seed);
  return out;
}

// Dirt and fading over metres, around 1.
float weathering(float u, float v, float strength, std::uint32_t seed) {
  return 1.0F + strength * fractal_noise(u * 1.3F, v * 1.3F, 5, seed + 911U);
}

// Small irregular specks, most of them much smaller than 1/frequency metres. `share` of the places have one.
float specks(float u, float v, float frequency, float share, std::uint32_t seed) {
  const float x = u * frequency, y = v * frequency;
  const CellNoise cell = cell_noise(x, y, seed);
  const std::uint32_t id = cell.id * 0x9e3779b1U;
  if (unit(id) > share) return 0;
  const float size = unit(id * 17U + 3U), radius = 0.05F + 0.35F * size * size * size;
  const float ragged = cell.distance * (1.0F + 0.45F * value_noise(x * 5.0F, y * 5.0F, id));
  return (1.0F - smooth_step(radius * 0.7F, radius, ragged)) * (0.4F + 0.6F * unit(id * 7U + 1U));
}

// Grain along u: long streaks, rings around knots.
float grain(float u, float v, std::uint32_t seed) {
  const CellNoise knot = cell_noise(u * 0.9F, v * 4.0F, seed + 3U);
  const bool knotted = unit(knot.id) < 0.35F;
  const float pull = knotted ? std::exp(-knot.distance * knot.distance * 40.0F) : 0.0F;
  const float warped = v + 0.02F * value_noise(u * 1.5F, v * 6.0F, seed + 5U) + 0.03F * pull;
  const float rings = std::sin(warped * 240.0F + 6.0F * fractal_noise(u * 1.2F, v * 9.0F, 3, seed + 7U));
  const float streaks = fractal_noise(u * 6.0F, v * 160.0F, 3, seed + 11U);
  return 0.10F * rings + 0.22F * streaks - 0.45F * smooth_step(0.35F, 0.9F, pull);
}

// Thin irregular lines between large cells.
float cracks(float u, float v, float frequency, std::uint32_t seed) {
  const float bend = 0.25F * fractal_noise(u * frequency * 3.0F, v * frequency * 3.0F, 3, seed + 1U);
  const CellNoise cell = cell_noise(u * frequency + bend, v * frequency - bend, seed);
  const float present = smooth_step(0.0F, 0.3F, value_noise(u * 1.1F, v * 1.1F, seed + 2U));
  return present * (1.0F - smooth_step(0.0F, 0.012F * frequency, cell.border));
}

}  // namespace

float brick_albedo(const Material& m, const SurfacePoint& p) {
  const float wobble_u = 0.004F * fractal_noise(p.u_m * 18.0F, p.v_m * 18.0F, 2, m.seed + 1U);
  const float wobble_v = 0.004F * fractal_noise(p.u_m * 18.0F, p.v_m * 18.0F, 2, m.seed + 2U);
  const Laid brick = lay(p.u_m + wobble_u, p.v_m + wobble_v, 0.25F, 0.083F, 0.5F, m.seed);
  const float rough = fractal_noise(p.u_m * 55.0F, p.v_m * 55.0F, 4, m.seed + 3U);
  const float face = smooth_step(0.004F, 0.008F, brick.edge_m + 0.0025F * rough);
  const float kind = unit(brick.id);
  float tone = m.tone * (0.55F + 0.75F * unit(brick.id * 7U + 1U));
  if (kind < 0.08F) tone *= 0.45F;  // burnt
  if (kind > 0.95F) tone *= 1.5F;   // lime-washed
  const float blotch = fractal_noise(p.u_m * 12.0F, p.v_m * 12.0F, 3, brick.id);
  const float pits = specks(p.u_m, p.v_m, 45.0F, 0.35F, m.seed + 4U);
  const float clay = tone * (1.0F + 0.35F * rough + 0.3F * blotch - 0.5F * pits);
  const float mortar = 0.62F + 0.16F * fractal_noise(p.u_m * 80.0F, p.v_m * 80.0F, 3, m.seed + 5U);
  return (mortar + (clay - mortar) * face) * weathering(p.u_m, p.v_m, 0.25F, m.seed);
}

float plaster_albedo(const Material& m, const SurfacePoint& p) {
  const float large = fractal_noise(p.u_m * 1.5F, p.v_m * 1.5F, 4, m.seed + 1U);
  const float trowel = fractal_noise(p.u_m * 9.0F, p.v_m * 14.0F, 4, m.seed + 2U);
  const float fine = fractal_noise(p.u_m * 90.0F, p.v_m * 90.0F, 2, m.seed + 3U);
  // Where the paint came off the darker coat below shows.
  const float peel_noise = fractal_noise(p.u_m * 3.1F, p.v_m * 3.1F, 6, m.seed + 4U);
  const float peeled = smooth_step(0.30F, 0.34F, peel_noise);
  const float rim = smooth_step(0.26F, 0.30F, peel_noise) - peeled;
  const float runs = fractal_noise(p.u_m * 14.0F, p.v_m * 0.9F, 4, m.seed + 5U);
  float value = m.tone * (1.0F + 0.22F * large + 0.16F * trowel + 0.10F * fine);
  value *= 1.0F - 0.30F * smooth_step(0.25F, 0.6F, runs) - 0.45F * peeled + 0.12F * rim;
  value *= 1.0F - 0.55F * cracks(p.u_m, p.v_m, 1.6F, m.seed + 6U);
  return value * (1.0F - 0.5F * specks(p.u_m, p.v_m, 21.0F, 0.25F, m.seed + 7U));
}

float planks_albedo(const Material& m, const SurfacePoint& p) {
  const Laid plank = lay(p.u_m, p.v_m, 1.15F, 0.125F, 0.37F, m.seed);
  const float tone = m.tone * (0.65F + 0.7F * unit(plank.id * 3U + 1U));
  const float shift = 10.0F * unit(plank.id);
  const float gap = 1.0F - smooth_step(0.0012F, 0.0040F, plank.edge_m);
  const float wear = fractal_noise(p.u_m * 5.0F, p.v_m * 5.0F, 5, m.seed + 9U);
  const float value = tone * (1.0F + 1.1F * grain(p.u_m + shift, p.v_m, plank.id) + 0.2F * wear);
  const float dents = specks(p.u_m, p.v_m, 16.0F, 0.25F, m.seed + 10U);
  return value * (1.0F - 0.75F * gap) * (1.0F - 0.4F * dents) * weathering(p.u_m, p.v_m, 0.2F, m.seed);
}

float tiles_albedo(const Material& m, const SurfacePoint& p) {
  constexpr float kTileM = 0.2F;
  const Laid tile = lay(p.u_m, p.v_m, kTileM, kTileM, 0.0F, m.seed);
  const float x = 2.0F * tile.in_u_m / kTileM - 1.0F, y = 2.0F * tile.in_v_m / kTileM - 1.0F;
  const float radius = std::sqrt(x * x + y * y), angle = std::atan2(y, x);
  const auto petals = static_cast<float>(4 + 2 * static_cast<int>(tile.id % 3U));
  const float flower = radius - (0.55F + 0.22F * std::cos(petals * angle));
  const float ring = std::abs(radius - 1.02F);
  const bool ornate = unit(tile.id * 13U) < 0.45F;
  float value = m.tone * (0.75F + 0.5F * unit(tile.id * 5U + 1U));
  if (ornate) {
    value *= 1.0F - 0.55F * (1.0F - smooth_step(-0.03F, 0.03F, flower));
    value *= 1.0F - 0.5F * (1.0F - smooth_step(0.06F, 0.10F, ring));
  }
  value *= 1.0F + 0.22F * fractal_noise(p.u_m * 30.0F, p.v_m * 30.0F, 4, tile.id);
  const float grout = 1.0F - smooth_step(0.002F, 0.005F, tile.edge_m);
  const float chips = specks(p.u_m, p.v_m, 20.0F, 0.25F, m.seed + 3U);
  value = (value + (0.2F - value) * grout) * (1.0F - 0.45F * chips);
  return value * weathering(p.u_m, p.v_m, 0.2F, m.seed);
}

float ceiling_albedo(const Material& m, const SurfacePoint& p) {
  const Laid panel = lay(p.u_m, p.v_m, 0.6F, 0.6F, 0.0F, m.seed);
  const float tone = m.tone * (0.88F + 0.2F * unit(panel.id));
  const float holes = specks(p.u_m, p.v_m, 28.0F, 0.5F, m.seed + 1U);
  const float worms = smooth_step(0.35F, 0.5F, fractal_noise(p.u_m * 24.0F, p.v_m * 24.0F, 2, panel.id));
  const float joint = 1.0F - smooth_step(0.004F, 0.010F, panel.edge_m);
  const float stain = smooth_step(0.28F, 0.45F, fractal_noise(p.u_m * 1.7F, p.v_m * 1.7F, 5, m.seed + 2U));
  return tone * (1.0F - 0.5F * holes) * (1.0F - 0.25F * worms) * (1.0F - 0.5F * joint) * (1.0F - 0.3F * stain);
}

float wood_albedo(const Material& m, const SurfacePoint& p) {
  // Grain runs along the longer side.
  const bool across = p.height_m > p.width_m;
  const float u = across ? p.v_m : p.u_m, v = across ? p.u_m : p.v_m;
  const float scratches = specks(p.u_m * 0.35F, p.v_m * 2.0F, 25.0F, 0.2F, m.seed + 3U);
  const float dents = specks(p.u_m, p.v_m, 24.0F, 0.2F, m.seed + 4U);
  const float worn = fractal_noise(p.u_m * 7.0F, p.v_m * 7.0F, 4, m.seed + 5U);
  return m.tone * (1.0F + 1.2F * grain(u, v, m.seed) + 0.22F * worn - 0.35F * dents - 0.25F * scratches);
}

float fabric_albedo(const Material& m, const SurfacePoint& p) {
  const float check_u = std::sin(p.u_m * 52.0F), check_v = std::sin(p.v_m * 52.0F);
  const float bands = 0.18F * (check_u > 0.55F ? 1.0F : 0.0F) - 0.18F * (check_v > 0.55F ? 1.0F : 0.0F);
  const float weave = 0.12F * std::sin(p.u_m * 700.0F) * std::sin(p.v_m * 700.0F);
  const float folds = fractal_noise(p.u_m * 4.0F, p.v_m * 4.0F, 5, m.seed);
  const float lint = specks(p.u_m, p.v_m, 30.0F, 0.2F, m.seed + 2U);
  return m.tone * (1.0F + bands + weave + 0.35F * folds + 0.4F * lint);
}

float paint_albedo(const Material& m, const SurfacePoint& p) {
  const float haze = fractal_noise(p.u_m * 3.0F, p.v_m * 3.0F, 5, m.seed);
  const float scuffs = smooth_step(0.32F, 0.42F, fractal_noise(p.u_m * 16.0F, p.v_m * 5.0F, 5, m.seed + 1U));
  const float chips = specks(p.u_m, p.v_m, 18.0F, 0.3F, m.seed + 2U);
  return m.tone * (1.0F + 0.15F * haze) * (1.0F - 0.3F * scuffs) * (1.0F - 0.6F * chips);
}

float rug_albedo(const Material& m, const SurfacePoint& p) {
  const float margin = std::min({p.u_m, p.v_m, p.width_m - p.u_m, p.height_m - p.v_m});
  const float pile = fractal_noise(p.u_m * 60.0F, p.v_m * 60.0F, 3, m.seed);
  const float worn = fractal_noise(p.u_m * 2.5F, p.v_m * 2.5F, 4, m.seed + 1U);
  const float x = p.u_m / 0.24F, y = p.v_m / 0.24F;
  const float fx = x - std::floor(x) - 0.5F, fy = y - std::floor(y) - 0.5F;
  const std::uint32_t id = hash_cell(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)), m.seed);
  const float diamond = std::abs(fx) + std::abs(fy);
  float value = m.tone;
  if (margin < 0.18F) {
    value = std::fmod(margin, 0.06F) < 0.03F ? 0.7F : 0.15F;
    if (margin > 0.06F && margin < 0.12F) value = std::fmod(p.u_m + p.v_m, 0.1F) < 0.05F ? 0.6F : 0.25F;
  } else if (diamond < 0.42F) {
    value = diamond < 0.2F ? 0.15F + 0.6F * unit(id * 3U) : 0.2F + 0.5F * unit(id);
  }
  return value * (1.0F + 0.35F * pile + 0.3F * worn);
}

float foliage_albedo(const Material& m, const SurfacePoint& p) {
  // Three layers of leaves, the nearer and larger ones in front.
  float value = 0.10F + 0.12F * fractal_noise(p.u_m * 2.0F, p.v_m * 2.0F, 4, m.seed);
  for (int layer = 0; layer < 3; ++layer) {
    const float frequency = 26.0F / static_cast<float>(1 << layer);
    const std::uint32_t seed = m.seed + 77U * static_cast<std::uint32_t>(layer);
    const CellNoise leaf = cell_noise(p.u_m * frequency, p.v_m * frequency * 0.7F, seed);
    if (unit(leaf.id * 11U) > 0.62F) continue;
    const float inside = 1.0F - smooth_step(0.36F, 0.42F, leaf.distance + 0.3F * (0.3F - leaf.border));
    const float shade = (0.12F + 0.65F * unit(leaf.id * 5U + 2U)) * (1.0F - 0.7F * leaf.distance);
    value += (shade - value) * inside;
  }
  return value * (1.0F + 0.25F * fractal_noise(p.u_m * 70.0F, p.v_m * 70.0F, 2, m.seed + 9U)) * (m.tone / 0.5F);
}

float leaf_albedo(const Material& m, const SurfacePoint& p) {
  const float x = p.u_m / p.width_m, y = p.v_m / p.height_m - 0.5F;
  const float middle = 1.0F - smooth_step(0.02F, 0.07F, std::abs(y));
  const float veins = 0.5F + 0.5F * std::sin((x * 9.0F + std::abs(y) * 7.0F) * 6.2832F);
  const float mottle = fractal_noise(p.u_m * 40.0F, p.v_m * 40.0F, 3, m.seed);
  return m.tone * (0.85F + 0.8F * middle + 0.25F * veins + 0.5F * mottle);
}

}  // namespace coslam::sim
