// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/appearance.h"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <random>

#include "server/estimator/solve/root_sift.h"

// The baseline of x86-64 has no instruction that counts bits; all processors since 2008 do.
#if defined(__x86_64__) && !defined(__POPCNT__)
#define COSLAM_ASK_FOR_POPCNT
#endif

namespace coslam {
namespace {

constexpr int kSketchBits = 128;
constexpr int kKeyBits = 14;    // of each table
constexpr int kMostApart = 30;  // bits in which two sketches of one thing differ at most

using Projections = Eigen::Matrix<float, kDescriptorBytes, kSketchBits>;

const Projections& projections() {
  static const Projections p = [] {
    std::mt19937 bits(20130213);
    Projections m;
    for (Eigen::Index i = 0; i < m.size(); ++i) m(i) = (bits() >> 16U & 1U) != 0 ? 1.0F : -1.0F;
    return m;
  }();
  return p;
}

std::uint32_t key_of(const std::array<std::uint64_t, 2>& sketch, int table) {
  const auto shift = static_cast<unsigned>(table % 4 * 16);
  return static_cast<std::uint32_t>(sketch[static_cast<std::size_t>(table / 4)] >> shift) & ((1U << kKeyBits) - 1U);
}

}  // namespace

std::vector<AppearanceIndex::Sketch> AppearanceIndex::sketches(const std::vector<std::uint8_t>& descriptors) const {
  Descriptors d = root_sift(descriptors);
  d.rowwise() -= Eigen::Map<const Eigen::Matrix<float, 1, kDescriptorBytes>>(mean_.data());
  const Eigen::Matrix<float, Eigen::Dynamic, kSketchBits, Eigen::RowMajor> projected = d * projections();
  std::vector<Sketch> out(static_cast<std::size_t>(projected.rows()), Sketch{});
  for (Eigen::Index r = 0; r < projected.rows(); ++r) {
    for (int b = 0; b < kSketchBits; ++b) {
      if (projected(r, b) > 0) out[static_cast<std::size_t>(r)][static_cast<std::size_t>(b / 64)] |= 1ULL << (b % 64);
    }
  }
  return out;
}

int AppearanceIndex::add(const std::vector<std::uint8_t>& descriptors) {
  if (mean_.empty() && !descriptors.empty()) {
    const Eigen::Matrix<float, 1, kDescriptorBytes> mean = root_sift(descriptors).colwise().mean();
    mean_.assign(mean.data(), mean.data() + mean.size());
  }
  const int image = images_++;
  if (descriptors.empty()) return image;
  for (const Sketch& s : sketches(descriptors)) {
    if (free_.empty()) {
      free_.push_back(static_cast<Slot>(entries_.size()));
      entries_.emplace_back();
    }
    const Slot slot = free_.back();
    free_.pop_back();
    entries_[slot] = {s, image};
    for (int t = 0; t < kTables; ++t) tables_[static_cast<std::size_t>(t)][key_of(s, t)].push_back(slot);
  }
  return image;
}

void AppearanceIndex::remove(int image, const std::vector<std::uint8_t>& descriptors) {
  if (descriptors.empty()) return;
  for (const Sketch& s : sketches(descriptors)) {
    std::optional<Slot> of_this;
    for (int t = 0; t < kTables; ++t) {
      auto& table = tables_[static_cast<std::size_t>(t)];
      const auto entry = table.find(key_of(s, t));
      if (entry == table.end()) continue;
      auto& bucket = entry->second;
      const auto at = std::ranges::find_if(bucket, [&](Slot slot) {
        return of_this ? slot == *of_this : entries_[slot].image == image && entries_[slot].sketch == s;
      });
      if (at == bucket.end()) continue;
      of_this = *at;
      bucket.erase(at);
      if (bucket.empty()) table.erase(entry);
    }
    if (of_this) free_.push_back(*of_this);
  }
}

std::size_t AppearanceIndex::bytes() const {
  std::size_t bytes = entries_.capacity() * sizeof(Entry) + free_.capacity() * sizeof(Slot);
  for (const auto& table : tables_) {
    for (const auto& [key, slots] : table)
      bytes += sizeof(key) + sizeof(std::vector<Slot>) + slots.capacity() * sizeof(Slot);
  }
  return bytes;
}

// Always inlined: what counts the bits is up to who calls it.
[[gnu::always_inline]] inline void AppearanceIndex::vote(const Sketch& s, int descriptor, Votes* votes) const {
  for (int t = 0; t < kTables; ++t) {
    const auto& table = tables_[static_cast<std::size_t>(t)];
    const auto at = table.find(key_of(s, t));
    if (at == table.end()) continue;
    for (const Slot slot : at->second) {
      const Entry& e = entries_[slot];
      const auto image = static_cast<std::size_t>(e.image);
      if (votes->last_of[image] == descriptor) continue;
      if (std::popcount(s[0] ^ e.sketch[0]) + std::popcount(s[1] ^ e.sketch[1]) > kMostApart) continue;
      votes->last_of[image] = descriptor;
      ++votes->counts[image];
    }
  }
}

void AppearanceIndex::vote_by_any(const Sketch& s, int descriptor, Votes* votes) const { vote(s, descriptor, votes); }

#ifdef COSLAM_ASK_FOR_POPCNT
[[gnu::target("popcnt")]] void AppearanceIndex::vote_by_popcnt(const Sketch& s, int descriptor, Votes* votes) const {
  vote(s, descriptor, votes);
}
#endif

std::vector<int> AppearanceIndex::votes(const std::vector<std::uint8_t>& descriptors) const {
  const auto images = static_cast<std::size_t>(images_);
  Votes votes{std::vector<int>(images, 0), std::vector<int>(images, -1)};
  if (mean_.empty() || descriptors.empty()) return votes.counts;
  auto vote_by = &AppearanceIndex::vote_by_any;
#ifdef COSLAM_ASK_FOR_POPCNT
  if (__builtin_cpu_supports("popcnt")) vote_by = &AppearanceIndex::vote_by_popcnt;
#endif
  int descriptor = 0;
  for (const Sketch& s : sketches(descriptors)) (this->*vote_by)(s, descriptor++, &votes);
  return votes.counts;
}

}  // namespace coslam
