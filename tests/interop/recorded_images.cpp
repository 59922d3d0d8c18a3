// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// recorded_images SOURCE: a line for each image of a recording: its time in nanoseconds, its size and its first pixel.
#include <iostream>

#include "agent/capture/source.h"
#include "common/base/error.h"

int main(int argc, char** argv) {
  try {
    const auto source = coslam::open_source(argc > 1 ? argv[1] : "", {});
    while (const auto image = source->next()) {
      std::cout << image->capture_ns << " " << image->grey.cols << "x" << image->grey.rows << " "
                << static_cast<int>(image->grey.at<unsigned char>(0, 0)) << "\n";
    }
  } catch (const coslam::UserError& e) {
    std::cerr << e.what() << "\n";
    return 1;
  }
  return 0;
}
