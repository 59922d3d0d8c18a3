// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The tracker on the first images of a folder, by kernels of choice, in one thread: tests/benchmark/instructions.py
// counts its instructions. Prints how many tracks there were and a sum over where they were, which is the same by all
// kernels.
//   coslam_benchmark_frames portable|vector FRAMES FOLDER
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "agent/track/kernels.h"
#include "agent/track/tracker.h"

namespace coslam {
namespace {

// All images are read however many are tracked, so that the difference of two counts is the tracker's alone.
std::vector<cv::Mat> images_in(const std::string& folder, std::size_t most) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<cv::Mat> images;
  for (std::size_t i = 0; i < std::min(files.size(), most); ++i) {
    images.push_back(cv::imread(files[i], cv::IMREAD_GRAYSCALE));
  }
  return images;
}

int track(std::size_t frames, const std::string& folder) {
  constexpr std::size_t kMostImages = 60;
  const std::vector<cv::Mat> images = images_in(folder, kMostImages);
  if (images.size() < frames) {
    std::cerr << folder << " has only " << images.size() << " images\n";
    return EXIT_FAILURE;
  }
  Tracker tracker({});
  std::size_t tracks = 0;
  std::uint64_t places = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    for (const Track& t : tracker.step(images[i])) {
      ++tracks;
      for (const float v : {t.raw_px.x(), t.raw_px.y()})
        places = places * 1099511628211U + std::bit_cast<std::uint32_t>(v);
    }
  }
  std::cout << frames << " frames, " << tracks << " places, sum " << std::hex << places << '\n';
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace coslam

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() != 3 || (words[0] != "portable" && words[0] != "vector")) {
    std::cerr << "usage: coslam_benchmark_frames portable|vector FRAMES FOLDER\n";
    return 2;
  }
  cv::setNumThreads(1);
  if (words[0] == "portable") coslam::use_kernels(coslam::portable_kernels());
  return coslam::track(std::stoul(words[1]), words[2]);
}
