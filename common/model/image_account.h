// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <string_view>

namespace coslam {

// Fate of an image that a source gave; each image has exactly one.
enum class ImageFate : std::uint8_t {
  kTracked,      // has a pose in the common map
  kInOtherMaps,  // in a map that could not be brought together with the common one
  kWithoutPose,  // the server used it, and it has none
  kLeftOut,      // the agent did not believe it, see ImageFault
  kNotSent,      // the agent had no time for it, or the link carries less
  kLost,         // sent, but did not arrive
  kLate,         // arrived when the server was past its instant
  kOutOfTime,    // has a stamp that is no valid time
  kSetLeftOut,   // the server had no time for its frame set
};
inline constexpr std::size_t kImageFates = 9;

struct ImageFateWords {
  std::string_view name;   // in files
  std::string_view after;  // a number of images: "3 lost on the way"
};
constexpr ImageFateWords words_of(ImageFate fate) {
  constexpr std::array<ImageFateWords, kImageFates> kWords{{
      {"tracked", "tracked"},
      {"in_other_maps", "in another map"},
      {"without_pose", "without a pose"},
      {"left_out", "not believed"},
      {"not_sent", "not sent in time"},
      {"lost", "lost on the way"},
      {"late", "too late for their instant"},
      {"out_of_time", "with stamps that are no times"},
      {"set_left_out", "left out by the server for lack of time"},
  }};
  return kWords[static_cast<std::size_t>(fate)];
}

// Counts of the images of one or more cameras by their fate.
struct ImageAccount {
  std::array<std::uint64_t, kImageFates> images{};

  std::uint64_t& operator[](ImageFate fate) { return images[static_cast<std::size_t>(fate)]; }
  std::uint64_t operator[](ImageFate fate) const { return images[static_cast<std::size_t>(fate)]; }
  // Number of images that the sources gave: the sum over all fates.
  std::uint64_t captured() const { return std::accumulate(images.begin(), images.end(), std::uint64_t{0}); }
  double percent(ImageFate fate) const {
    const std::uint64_t all = captured();
    return all == 0 ? 0 : 100 * static_cast<double>((*this)[fate]) / static_cast<double>(all);
  }
  // Text on the images that were not tracked: "19 not sent in time, 3 lost on the way"; empty: there are none.
  std::string losses() const;

  ImageAccount& operator+=(const ImageAccount& other);
  bool operator==(const ImageAccount&) const = default;
};

// "cam0: of 300 images 19 not sent in time, 3 lost on the way".
std::string losses_of(const std::string& agent, const ImageAccount& images);

}  // namespace coslam
