// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "common/base/time.h"

namespace coslam {

struct ListedFrame {
  TimeNs source_ns = 0;
  std::filesystem::path file;
};

// The images of a source with their times, ascending. Each reads one layout and throws UserError with file and line.
using FrameList = std::vector<ListedFrame>;

FrameList list_csv(const std::filesystem::path& file);             // `t_s,file`, paths relative to the CSV
FrameList list_tum(const std::filesystem::path& rgb_txt);          // `t_s file`
FrameList list_euroc(const std::filesystem::path& camera_folder);  // data.csv: `t_ns,file`, images in data/
FrameList list_images(const std::filesystem::path& folder, double rate_hz);

// Recognises the layout of a folder: EuRoC (the sequence, mav0 or camN), TUM, KITTI (the sequence or image_N), else
// images.
FrameList list_folder(const std::filesystem::path& folder, double rate_hz);

// One time in seconds a line, ascending. UTC times count from the first.
std::vector<TimeNs> read_times(const std::filesystem::path& file);

}  // namespace coslam
