// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace coslam {

// Why an image is not to be believed. Such images are left out: they become no frames.
enum class ImageFault : std::uint8_t {
  kNone,
  kMissing,      // none came when one was due
  kUnreadable,   // no picture could be made of what came
  kResized,      // has another size than the first image
  kConcealed,    // contains parts that the decoder made up because they did not arrive
  kCutOff,       // ends in the same row again and again
  kRepeated,     // the image before, bit by bit
  kOutOfOrder,   // an image from earlier, bit by bit
  kFeatureless,  // shows nothing: dark, dazzled or covered
  kAlternating,  // has another exposure setting, of a camera that alternates between several; the other images are good
};
inline constexpr std::size_t kImageFaults = 10;

struct ImageFaultWords {
  std::string_view name;  // in files and on the wire of others
  std::string_view why;   // continues "not to be believed: "
};
constexpr ImageFaultWords words_of(ImageFault fault) {
  constexpr std::array<ImageFaultWords, kImageFaults> kWords{{
      {"none", "nothing is wrong with them"},
      {"missing", "none come"},
      {"unreadable", "they cannot be read"},
      {"resized", "their size is not that of the first"},
      {"concealed", "parts did not arrive and are made up by the decoder"},
      {"cut_off", "they end in one row again and again"},
      {"repeated", "they are the same bit by bit"},
      {"out_of_order", "images from earlier come again"},
      {"featureless", "nothing is to be seen in them: it is dark, dazzling, or the lens is covered"},
      {"alternating", "they are of another setting"},
  }};
  return kWords[static_cast<std::size_t>(fault)];
}

}  // namespace coslam
