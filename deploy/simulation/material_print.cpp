// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "deploy/simulation/material.h"
#include "deploy/simulation/noise.h"

namespace coslam::sim {
namespace {

constexpr float kTwoPi = 6.2831853F;

bool inside(float x, float low, float high) { return x >= low && x < high; }

// Ink of a character cell: a random choice of the strokes of a seven-segment digit and two diagonals. x, y in [0, 1).
bool glyph_ink(float x, float y, std::uint32_t id) {
  constexpr float kPen = 0.2F;
  const std::uint32_t strokes = id | (id >> 9);
  const bool upper = y < 0.5F;
  if ((strokes & 1U) != 0 && y < kPen) return true;
  if ((strokes & 2U) != 0 && std::abs(y - 0.5F) < kPen / 2) return true;
  if ((strokes & 4U) != 0 && y > 1 - kPen) return true;
  if (x < kPen && (strokes & (upper ? 8U : 16U)) != 0) return true;
  if (x > 1 - kPen && (strokes & (upper ? 32U : 64U)) != 0) return true;
  if ((strokes & 384U) == 128U && std::abs(x - y) < kPen * 0.6F) return true;
  return (strokes & 384U) == 256U && std::abs(x + y - 1.0F) < kPen * 0.6F;
}

// Ink of lines of pseudo-text with letters size_m high, starting at (0, 0). Words, and a ragged right margin.
bool text_ink(float u, float v, float width_m, float size_m, std::uint32_t seed) {
  if (u < 0 || v < 0 || u > width_m) return false;
  const float line_m = size_m * 1.7F, cell_m = size_m * 0.85F;
  const int line = static_cast<int>(v / line_m);
  const float y = (v - static_cast<float>(line) * line_m) / size_m;
  if (y >= 1.0F) return false;
  const std::uint32_t line_id = hash_cell(line, 0, seed);
  if (line_id % 9U == 0) return false;  // paragraphs
  if (u > width_m * (0.75F + 0.25F * unit(line_id * 3U))) return false;
  const int column = static_cast<int>(u / cell_m);
  const float x = (u - static_cast<float>(column) * cell_m) / (size_m * 0.62F);
  const std::uint32_t id = hash_cell(column, line, seed + 1U);
  if (x >= 1.0F || unit(id) < 0.17F) return false;
  return glyph_ink(x, y, id >> 3);
}

// Mountains under a sky with a sun. x, y in [0, 1].
float landscape(float x, float y, std::uint32_t seed) {
  float value = 0.75F - 0.25F * y + 0.12F * fractal_noise(x * 4.0F, y * 9.0F, 5, seed);
  const float sun_x = 0.2F + 0.6F * unit(seed * 5U + 1U), sun_y = 0.12F + 0.2F * unit(seed * 7U + 1U);
  if (std::hypot(x - sun_x, y - sun_y) < 0.08F) value = 0.93F;
  for (int layer = 0; layer < 3; ++layer) {
    const auto depth = static_cast<float>(layer);
    const std::uint32_t id = seed + 31U * static_cast<std::uint32_t>(layer + 1);
    const float ridge = 0.38F + 0.2F * depth - 0.22F * fractal_noise(x * (3.0F + 2.0F * depth), depth, 6, id);
    if (y < ridge) continue;
    const float rock = fractal_noise(x * 26.0F, (y - ridge) * 30.0F, 5, id + 1U);
    value = (0.52F - 0.16F * depth) * (1.0F + 0.75F * rock);
  }
  return value;
}

// Overlapping discs, bars and triangles.
float abstract_art(float x, float y, std::uint32_t seed) {
  float value = 0.7F + 0.1F * fractal_noise(x * 8.0F, y * 8.0F, 4, seed);
  for (int i = 0; i < 18; ++i) {
    const std::uint32_t id = hash_cell(i, 3, seed);
    const float cx = unit(id), cy = unit(id * 3U + 1U), size = 0.05F + 0.17F * unit(id * 5U + 1U);
    const float angle = kTwoPi * unit(id * 11U + 1U), c = std::cos(angle), s = std::sin(angle);
    const float dx = c * (x - cx) + s * (y - cy), dy = c * (y - cy) - s * (x - cx);
    bool hit = false;
    if (id % 3U == 0) hit = dx * dx + dy * dy < size * size;
    if (id % 3U == 1) hit = std::abs(dx) < size * 1.6F && std::abs(dy) < size * 0.35F;
    if (id % 3U == 2) hit = dy > -size * 0.5F && std::abs(dx) < (size - dy) * 0.6F;
    if (hit) value = 0.06F + 0.85F * unit(id * 19U + 1U);
  }
  return value * (1.0F + 0.18F * fractal_noise(x * 45.0F, y * 45.0F, 3, seed + 2U));
}

// A town map: blocks, streets, a river, labels.
float town_map(float x, float y, std::uint32_t seed) {
  const float bend = 0.4F * fractal_noise(x * 4.0F, y * 4.0F, 3, seed);
  const CellNoise block = cell_noise(x * 11.0F + bend, y * 11.0F - bend, seed);
  float value = block.border < 0.10F ? 0.9F : 0.30F + 0.45F * unit(block.id);
  const float river = y - 0.5F - 0.3F * fractal_noise(x * 2.0F, 0.5F, 4, seed + 1U);
  if (std::abs(river) < 0.035F) value = 0.18F;
  if (text_ink(std::fmod(x, 0.25F) - 0.03F, std::fmod(y, 0.2F) - 0.05F, 0.19F, 0.02F, seed + 2U)) value = 0.08F;
  return value;
}

float bar_chart(float x, float y, std::uint32_t seed) {
  const int column = static_cast<int>(x * 12.0F);
  const float height = 0.15F + 0.75F * unit(hash_cell(column, 0, seed));
  const float in_column = x * 12.0F - static_cast<float>(column);
  float value = 0.85F;
  if (std::fmod(y, 0.125F) < 0.012F) value = 0.5F;
  if (1.0F - y < height && inside(in_column, 0.15F, 0.85F)) {
    value = 0.10F + 0.6F * unit(hash_cell(column, 1, seed));
    if (std::fmod(y * 40.0F + in_column * 3.0F, 2.0F) < 0.7F) value += 0.15F;
  }
  return value;
}

// One of several kinds of picture; x, y in [0, 1].
float picture(float x, float y, float width_m, float height_m, std::uint32_t seed) {
  switch (seed % 5U) {
    case 0:
      return landscape(x, y, seed);
    case 1:
      return abstract_art(x, y * height_m / width_m, seed);
    case 2:
      return town_map(x, y * height_m / width_m, seed);
    case 3:
      return bar_chart(x, y, seed);
    default: {
      const Material foliage{MaterialKind::kFoliage, seed, 0.6F};
      return foliage_albedo(foliage, {x * width_m * 2.0F, y * height_m * 2.0F, width_m, height_m});
    }
  }
}

float paper(const Material& m, const SurfacePoint& p) {
  return m.tone * (1.0F + 0.05F * fractal_noise(p.u_m * 8.0F, p.v_m * 8.0F, 4, m.seed + 40U));
}

}  // namespace

float poster_albedo(const Material& m, const SurfacePoint& p) {
  const float margin = 0.045F * p.width_m;
  const float u = p.u_m - margin, v = p.v_m - margin;
  const float width = p.width_m - 2 * margin, height = p.height_m - 2 * margin;
  const bool dark = m.seed % 4U == 1;
  const float ground = dark ? 0.12F : paper(m, p), ink = dark ? 0.85F : 0.07F;
  const float title = 0.085F * p.height_m;
  if (text_ink(u, v, width, title, m.seed + 1U) && v < title) return ink;
  const float top = 1.5F * title, bottom = 0.68F * height;
  if (inside(u, 0, width) && inside(v, top, bottom)) {
    return picture(u / width, (v - top) / (bottom - top), width, bottom - top, mix(m.seed) >> 40);
  }
  const float column = 0.5F * width, gap = 0.03F * width;
  const float in_column = u < column ? u : u - column;
  const float text = v - bottom - 0.03F * height;
  const bool row = inside(text, 0, 0.28F * height);
  return row && text_ink(in_column, text, column - gap, 0.014F, m.seed + (u < column ? 2U : 3U)) ? ink : ground;
}

float picture_albedo(const Material& m, const SurfacePoint& p) {
  const float edge = std::min({p.u_m, p.v_m, p.width_m - p.u_m, p.height_m - p.v_m});
  if (edge < 0.025F) {
    return (m.seed % 2U == 0 ? 0.12F : 0.45F) * (1.0F + 0.4F * fractal_noise(p.u_m * 30.0F, p.v_m * 30.0F, 3, m.seed));
  }
  if (edge < 0.05F) return 0.85F;
  return picture(p.u_m / p.width_m, p.v_m / p.height_m, p.width_m, p.height_m, m.seed);
}

float newspaper_albedo(const Material& m, const SurfacePoint& p) {
  const float ground = paper(m, p);
  const float head = 0.04F;
  if (p.v_m < head * 1.6F) {
    return text_ink(p.u_m - 0.02F, p.v_m - 0.012F, p.width_m - 0.04F, head, m.seed) ? 0.08F : ground;
  }
  const float column_m = 0.12F;
  const int column = static_cast<int>(p.u_m / column_m), block = static_cast<int>(p.v_m / 0.15F);
  const float u = p.u_m - static_cast<float>(column) * column_m, v = p.v_m - static_cast<float>(block) * 0.15F;
  const std::uint32_t id = hash_cell(column, block, m.seed);
  if (id % 4U == 0 && inside(u, 0.008F, 0.112F) && inside(v, 0.01F, 0.13F)) {
    return picture((u - 0.008F) / 0.104F, (v - 0.01F) / 0.12F, 0.104F, 0.12F, id >> 4);
  }
  return text_ink(u - 0.008F, v - 0.01F, 0.104F, 0.009F, id) ? 0.12F : ground;
}

float carton_albedo(const Material& m, const SurfacePoint& p) {
  const float flutes =
      0.05F * std::sin(p.u_m * 900.0F) + 0.16F * fractal_noise(p.u_m * 12.0F, p.v_m * 12.0F, 5, m.seed);
  float value = m.tone * (1.0F + flutes);
  const float from_middle = std::abs(p.v_m - 0.5F * p.height_m);
  if (from_middle < 0.025F) value = 0.68F + 0.1F * fractal_noise(p.u_m * 25.0F, p.v_m * 60.0F, 3, m.seed + 1U);
  const float lu = p.u_m - 0.1F * p.width_m, lv = p.v_m - 0.60F * p.height_m;
  if (inside(lu, 0, 0.45F * p.width_m) && inside(lv, 0, 0.32F * p.height_m)) {
    const bool bars = lv < 0.1F * p.height_m && (hash_cell(static_cast<int>(lu / 0.004F), 0, m.seed) & 1U) != 0;
    const bool text =
        lv > 0.12F * p.height_m && text_ink(lu - 0.01F, lv - 0.12F * p.height_m, 0.4F * p.width_m, 0.016F, m.seed);
    value = bars || text ? 0.08F : 0.88F;
  }
  if (text_ink(p.u_m - 0.08F * p.width_m, p.v_m - 0.1F * p.height_m, 0.8F * p.width_m, 0.055F, m.seed + 2U) &&
      p.v_m < 0.1F * p.height_m + 0.055F) {
    value *= 0.35F;
  }
  const float worn = smooth_step(0.02F, 0.0F, std::min({p.u_m, p.v_m, p.width_m - p.u_m, p.height_m - p.v_m}));
  return value * (1.0F + 0.25F * worn);
}

float book_spine_albedo(const Material& m, const SurfacePoint& p) {
  // Bands above and below, the title along the spine.
  const float ink = m.tone > 0.4F ? 0.08F : 0.85F;
  const float y = p.v_m / p.height_m;
  float value = m.tone * (1.0F + 0.2F * fractal_noise(p.u_m * 50.0F, p.v_m * 50.0F, 4, m.seed));
  const float band = 0.06F + 0.1F * unit(m.seed * 3U);
  if (inside(y, band, band + 0.035F) || inside(y, 0.96F - band, 1.0F - band)) value = 0.5F * (ink + m.tone);
  const float size = std::clamp(0.5F * p.width_m, 0.008F, 0.03F);
  const float across = p.width_m - p.u_m - 0.5F * (p.width_m - size);
  if (inside(y, 0.25F, 0.78F) && across < size &&
      text_ink(p.v_m - 0.25F * p.height_m, across, 0.5F * p.height_m, size, m.seed * 9U + 4U)) {
    value = ink;
  }
  const float edge = std::min(p.u_m, p.width_m - p.u_m);
  return value * (0.65F + 0.35F * smooth_step(0.0F, 0.006F, edge));
}

float pages_albedo(const Material& m, const SurfacePoint& p) {
  const float sheets =
      value_noise(p.u_m * 6.0F, p.v_m * 700.0F, m.seed) + value_noise(p.u_m * 700.0F, p.v_m * 6.0F, m.seed);
  return m.tone * (1.0F + 0.12F * sheets + 0.15F * fractal_noise(p.u_m * 20.0F, p.v_m * 20.0F, 4, m.seed + 1U));
}

float tag_albedo(const Material& m, const SurfacePoint& p) {
  // By rows, the left cell in the highest bit; 1 is paper.
  constexpr std::array<unsigned, kTagCells> kRows{0x00, 0x10, 0x34, 0x0a, 0x0c, 0x5c, 0x56, 0x00};
  constexpr float kInk = 0.04F;
  const auto cell = [](float at_m, float size_m) {
    return static_cast<int>(std::floor(at_m / size_m * (kTagCells + 2))) - 1;
  };
  const int column = cell(p.u_m, p.width_m), row = cell(p.v_m, p.height_m);
  if (std::min(column, row) < 0 || std::max(column, row) >= kTagCells) return paper(m, p);
  const unsigned bits = kRows[static_cast<std::size_t>(row)];
  return ((bits >> (kTagCells - 1 - column)) & 1U) != 0 ? paper(m, p) : kInk;
}

float screen_albedo(const Material& m, const SurfacePoint& p) {
  const float edge = std::min({p.u_m, p.v_m, p.width_m - p.u_m, p.height_m - p.v_m});
  if (edge < 0.015F) return 0.05F;
  const float u = p.u_m - 0.015F, v = p.v_m - 0.015F, half = 0.5F * p.width_m;
  if (v < 0.02F) return text_ink(u, v - 0.004F, p.width_m, 0.011F, m.seed) ? 0.1F : 0.7F;
  if (u < half) return text_ink(u - 0.01F, v - 0.03F, half - 0.03F, 0.012F, m.seed + 1U) ? 0.8F : 0.10F;
  return picture((u - half) / half, v / p.height_m, half, p.height_m, m.seed);
}

}  // namespace coslam::sim
