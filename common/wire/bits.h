// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

// Octets filled bit by bit, low bits first, and the codes of numbers that are mostly small. For the codec only.
namespace coslam {

// Rice code with parameter k: the number without its k low bits in unary, then those. From kRiceEscape on, as many ones
// and the number itself in `raw_bits`, so that no number is much longer than that.
constexpr std::uint32_t kRiceEscape = 15;
constexpr int kRiceParameterBits = 5;

class BitWriter {
 public:
  void put(std::uint64_t value, int bits) {
    for (int i = 0; i < bits; ++i, ++used_) {
      if (used_ % 8 == 0) octets_.push_back(0);
      octets_.back() = static_cast<std::uint8_t>(octets_.back() | (value >> i & 1U) << used_ % 8);
    }
  }

  // A number below `bound`: those that come first are a bit shorter when the bound is no power of two.
  void put_below(std::uint32_t value, std::uint32_t bound) {
    if (bound == 0) return;  // no value is below 0
    const int bits = std::bit_width(bound) - 1;
    const std::uint32_t shorter = (2U << bits) - bound;
    if (value < shorter) return put(value, bits);
    put((value + shorter) >> 1U, bits);
    put((value + shorter) & 1U, 1);
  }

  // Writes a list, whose size the reader knows, in the Rice code that is shortest for it.
  void put_list(std::span<const std::uint32_t> values, int raw_bits) {
    const int k = best_parameter(values, raw_bits);
    put(static_cast<std::uint64_t>(k), kRiceParameterBits);
    for (const std::uint32_t value : values) put_rice(value, k, raw_bits);
  }

  std::vector<std::uint8_t> take() { return std::move(octets_); }

 private:
  static std::uint64_t rice_bits(std::uint32_t value, int k, int raw_bits) {
    const std::uint32_t high = value >> k;
    return high < kRiceEscape ? high + 1 + static_cast<std::uint32_t>(k)
                              : kRiceEscape + static_cast<std::uint32_t>(raw_bits);
  }

  static int best_parameter(std::span<const std::uint32_t> values, int raw_bits) {
    int best = 0;
    std::uint64_t fewest = UINT64_MAX;
    for (int k = 0; k < raw_bits; ++k) {
      std::uint64_t bits = 0;
      for (const std::uint32_t value : values) bits += rice_bits(value, k, raw_bits);
      if (bits >= fewest) continue;
      fewest = bits;
      best = k;
    }
    return best;
  }

  void put_rice(std::uint32_t value, int k, int raw_bits) {
    const std::uint32_t high = value >> k;
    put((1U << std::min(high, kRiceEscape)) - 1, static_cast<int>(std::min(high, kRiceEscape)));
    if (high >= kRiceEscape) return put(value, raw_bits);
    put(0, 1);
    put(value, k);
  }

  std::vector<std::uint8_t> octets_;
  std::size_t used_ = 0;  // bits
};

// Reads what a BitWriter wrote. Past the end, and after a code that no writer makes, everything reads as 0 and ok() is
// false for good: ask once after a loop that is bounded anyway.
class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t> octets) : octets_(octets) {}

  bool ok() const { return ok_; }
  // Whether only the padding of the last octet is left.
  bool at_end() {
    const std::size_t left = 8 * octets_.size() - at_;
    return ok_ && left < 8 && get(static_cast<int>(left)) == 0;
  }

  std::uint32_t get(int bits) {
    if (!ok_ || static_cast<std::size_t>(bits) > 8 * octets_.size() - at_) return fail();
    std::uint32_t value = 0;
    for (int i = 0; i < bits; ++i, ++at_) {
      value |= static_cast<std::uint32_t>(octets_[at_ / 8] >> at_ % 8 & 1) << i;
    }
    return value;
  }

  std::uint32_t get_below(std::uint32_t bound) {
    if (bound == 0) return fail();
    const int bits = std::bit_width(bound) - 1;
    const std::uint32_t shorter = (2U << bits) - bound;
    const std::uint32_t value = get(bits);
    return value < shorter ? value : (value << 1U | get(1)) - shorter;
  }

  std::vector<std::uint32_t> get_list(std::size_t count, int raw_bits) {
    const int k = static_cast<int>(get(kRiceParameterBits));
    if (k >= raw_bits) fail();
    std::vector<std::uint32_t> values;
    if (!ok_) return values;
    values.reserve(count);
    while (values.size() < count && ok_) values.push_back(get_rice(k, raw_bits));
    values.resize(count);
    return values;
  }

 private:
  std::uint32_t fail() {
    ok_ = false;
    return 0;
  }

  std::uint32_t get_rice(int k, int raw_bits) {
    std::uint32_t high = 0;
    while (high < kRiceEscape && get(1) == 1) ++high;
    if (high == kRiceEscape) {
      const std::uint32_t value = get(raw_bits);
      return value >> k >= kRiceEscape ? value : fail();  // a shorter code would exist otherwise
    }
    const std::uint64_t value = static_cast<std::uint64_t>(high) << k | get(k);
    return value >> raw_bits == 0 ? static_cast<std::uint32_t>(value) : fail();
  }

  std::span<const std::uint8_t> octets_;
  std::size_t at_ = 0;  // bits
  bool ok_ = true;
};

}  // namespace coslam
