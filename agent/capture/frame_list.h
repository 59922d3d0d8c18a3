// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "agent/capture/stamps.h"
#include "common/base/time.h"

namespace coslam {

struct ListedFrame {
  TimeNs source_ns = 0;
  std::filesystem::path file;
};

// The images of a source with their times, ascending, as source_times() has them. Each reads one layout and throws
// UserError with file and line.
struct FrameList {
  std::vector<ListedFrame> frames;
  std::vector<std::optional<TimeNs>> all_ns;  // times of all images that were there, with those that were left out
  TimeNs zero_ns = 0;                         // zero of the times, as it was written
  std::vector<std::string> guesses;           // sentences for the user
  bool at_rate = false;                       // the images have no times, and come at the rate
};

FrameList list_csv(const std::filesystem::path& file);             // `t_s,file[,...]`, paths relative to the CSV
FrameList list_tum(const std::filesystem::path& rgb_txt);          // `t_s file`, or of both colour and depth
FrameList list_euroc(const std::filesystem::path& camera_folder);  // data.csv: `t_ns,file`, images in data/
FrameList list_images(const std::filesystem::path& folder, double rate_hz);

// Recognises the layout of a folder: EuRoC (the sequence, mav0 or camN), TUM, KITTI (the sequence or image_N; of raw
// recordings the drive, image_NN or its data), else images.
FrameList list_folder(const std::filesystem::path& folder, double rate_hz);

// Reads a file with one time a line, see source_times(): one for each image, none where it is to be left out.
SourceTimes read_times(const std::filesystem::path& file);

}  // namespace coslam
