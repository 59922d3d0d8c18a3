// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "agent/capture/stamps.h"

// Reads cameras, order and times from the names of images in a folder.
namespace coslam {

// Tells by the ending whether OpenCV reads the file as pixels of 8 or 16 bits.
bool is_image(const std::filesystem::path& file);

// Image files by the numbers in their names, so that 999 precedes 1000 and -1 precedes 0; hidden ones are left out.
std::vector<std::filesystem::path> images_in(const std::filesystem::path& folder);

// Content of a folder without images, as the end of a sentence: "; it holds 120 files .npy". Empty: nothing.
std::string instead_of_images(const std::filesystem::path& folder);

// Selects the files of one camera. Depth images beside others are left out, which is said in `guesses`. Throws
// UserError where the names without their numbers are those of several cameras.
std::vector<std::filesystem::path> of_one_camera(const std::filesystem::path& folder,
                                                 const std::vector<std::filesystem::path>& files,
                                                 std::vector<std::string>* guesses);

// The number in each name that differs from image to image, if there is just one and it ascends; else empty.
std::vector<std::int64_t> numbers_of(const std::vector<std::filesystem::path>& files);

// Times that all names end with: `1403638518077829376`, `1403638518.077829`,
// `1403638518_077829376`, `12.05`, `2014-06-24T19-35-18.050000`, `20140624_193518050`. Or numbers that
// are no counts of images, as a clock's that counts since it was started: `12345678`.
struct NamedTimes {
  std::vector<WrittenTime> times;  // times by image; empty: the names are no times
  TimeUnit unit = TimeUnit::kSeconds;
  bool vague = false;   // times may be mere numbers: only the rate of a camera makes times of them
  bool coarse = false;  // dates of whole seconds
};
NamedTimes times_in_names(const std::vector<std::filesystem::path>& files);

}  // namespace coslam
