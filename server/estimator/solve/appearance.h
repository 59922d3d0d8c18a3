// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace coslam {

// Index of images by appearance, without a vocabulary that would have to be trained: every descriptor is reduced to the
// signs of 128 random projections; descriptors that agree in all bits of some part of them (locality-sensitive hashing)
// and differ in few bits altogether vote for their image. Deterministic.
class AppearanceIndex {
 public:
  // Adds an image with its descriptors, kDescriptorBytes each. Images are numbered from 0; returns the number.
  int add(const std::vector<std::uint8_t>& descriptors);
  // Leaves out this many image numbers.
  void skip(int images) { images_ += images; }
  // Removes an image, which gets no more votes; its number is not given again. Takes the descriptors that it was added
  // with.
  void remove(int image, const std::vector<std::uint8_t>& descriptors);
  // Counts for every image how many of these descriptors have a similar one in it.
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
  using Slot = std::uint32_t;  // index into entries_

  struct Votes {
    std::vector<int> counts;   // votes of each image
    std::vector<int> last_of;  // last descriptor that voted for each image
  };

  void vote(const Sketch& s, int descriptor, Votes* votes) const;
  void vote_by_any(const Sketch& s, int descriptor, Votes* votes) const;
  void vote_by_popcnt(const Sketch& s, int descriptor, Votes* votes) const;
  std::vector<Sketch> sketches(const std::vector<std::uint8_t>& descriptors) const;

  std::vector<float> mean_;  // mean of the first image's descriptors: most of what all descriptors share
  std::vector<Entry> entries_;
  std::vector<Slot> free_;  // free places in entries_
  std::array<std::unordered_map<std::uint32_t, std::vector<Slot>>, kTables> tables_;
  int images_ = 0;
};

}  // namespace coslam
