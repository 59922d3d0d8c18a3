// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "common/dataset/trajectory.h"

namespace coslam::plot {

using Positions = std::vector<Eigen::Vector3d>;

struct TopViewPath {
  std::string label;  // in the legend
  Positions estimate;
  Positions truth;  // may be empty
};

// Content of the picture, all in one frame.
struct TopView {
  std::string title;
  std::string unit = "m";  // unit of the scale bar
  Positions points;
  Positions moving;  // places of moving points at any time
  std::vector<TopViewPath> paths;
  Eigen::Vector3d up = Eigen::Vector3d::Zero();  // mean of the cameras' unit vectors upwards; 0: not known
};

// A map as seen from above: the projection along "up" where the cameras agree on it, else on the plane of widest
// spread (principal axes of paths and points). The window takes in all paths and all points but wild ones.
cv::Mat draw_top_view(const TopView& view, int width_px = 1400, int height_px = 1000);

void save_picture(const std::filesystem::path& file, const cv::Mat& picture);  // throws UserError

}  // namespace coslam::plot
