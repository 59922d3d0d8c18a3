// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace coslam {

// Images by what they look like, without a vocabulary that would have to be trained: every descriptor is cut down to
// the signs of 128 random projections; descriptors that agree in all bits of some part of them (locality-sensitive
// hashing) and differ in few bits altogether vote for their image. Deterministic.
class AppearanceIndex {
 public:
  // Descriptors of kDescriptorBytes each. Images are numbered from 0; returns the number.
  int add(const std::vector<std::uint8_t>& descriptors);
  // So many numbers are given to no image.
  void skip(int images) { images_ += images; }
  // It gets no votes any more; its number stays its own. By the descriptors that it was added with.
  void remove(int image, const std::vector<std::uint8_t>& descriptors);
  // For every image, how many of these descriptors have one like them in it.
  std::vector<int> votes(const std::vector<std::uint8_t>& descriptors) const;
  int size() const { return images_; }
  std::size_t bytes() const;

 private:
  static constexpr int kTables = 8;
  using Sketch = std::array<std::uint64_t, 2>;
  struct Entry {
    Sketch sketch;
    int image;
  };
  using Slot = std::uint32_t;  // of entries_

  struct Votes {
    std::vector<int> of;       // each image
    std::vector<int> last_of;  // the descriptor that voted for it last
  };

  void vote(const Sketch& s, int descriptor, Votes* votes) const;
  void vote_by_any(const Sketch& s, int descriptor, Votes* votes) const;
  void vote_by_popcnt(const Sketch& s, int descriptor, Votes* votes) const;
  std::vector<Sketch> sketches(const std::vector<std::uint8_t>& descriptors) const;

  std::vector<float> mean_;  // of the first image's descriptors: most of what all descriptors share
  std::vector<Entry> entries_;
  std::vector<Slot> free_;  // of entries_
  std::array<std::unordered_map<std::uint32_t, std::vector<Slot>>, kTables> tables_;
  int images_ = 0;
};

}  // namespace coslam
