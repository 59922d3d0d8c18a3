// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// Hash-based randomness of the simulated worlds: the same arguments give the same value on every machine.
namespace coslam::sim {

// SplitMix64: decorrelates consecutive keys.
constexpr std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}
constexpr std::uint64_t mix(std::uint64_t a, std::uint64_t b) { return mix(mix(a) ^ b); }

constexpr std::uint32_t hash_cell(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  // Linear in x and y up to the scrambling, so that the corners of a cell share most of the work.
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x85ebca6bU + static_cast<std::uint32_t>(y) * 0xc2b2ae35U;
  h += seed * 0x9e3779b1U;
  h = (h ^ (h >> 16)) * 0x7feb352dU;
  h = (h ^ (h >> 15)) * 0x846ca68bU;
  return h ^ (h >> 16);
}
// Uniform in [0, 1).
constexpr float unit(std::uint32_t h) { return static_cast<float>(h >> 8) * (1.0F / 16777216.0F); }

// A small sequential generator for layouts.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(mix(seed)) {}
  std::uint64_t next() { return mix(state_++); }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(next() >> 11) * (1.0 / 9007199254740992.0);
  }
  int index(int count) { return static_cast<int>(next() % static_cast<std::uint64_t>(count)); }

 private:
  std::uint64_t state_;
};

float smooth_step(float low, float high, float x);
// Smooth noise with features of size 1, in [-1, 1].
float value_noise(float x, float y, std::uint32_t seed);
// Sum of octaves of value_noise, each twice as fine and half as strong; about [-1, 1].
float fractal_noise(float x, float y, int octaves, std::uint32_t seed);

// The nearest of one random site per unit cell: distance to it, how much farther the second is, and its id.
struct CellNoise {
  float distance = 0;
  float border = 0;
  std::uint32_t id = 0;
};
CellNoise cell_noise(float x, float y, std::uint32_t seed);

}  // namespace coslam::sim
