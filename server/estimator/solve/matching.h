// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"

namespace coslam {

// Features of one image with descriptors of kDescriptorBytes each.
struct FeatureImage {
  CameraModel camera;
  std::vector<Eigen::Vector2d> undistorted_px;
  std::vector<std::uint8_t> descriptors;
  std::string rig = {};      // rig that its camera is part of; empty: none
  Rigid3 cam_from_rig = {};  // metres
};

// Pixels of this camera for one of an image that is 640 pixels wide.
inline double width_scale(const CameraModel& camera) { return camera.width_px / 640.0; }

struct FeatureMatch {
  int first = 0, second = 0;
  float distance = 0;
};

// Ratio test (Lowe): a match has to be nearer than this share of the distance of the second best.
inline constexpr float kDistinctRatio = 0.8F;
// Matches descriptors: mutual nearest neighbours that pass the ratio test, on RootSIFT.
std::vector<FeatureMatch> match_descriptors(const std::vector<std::uint8_t>& first,
                                            const std::vector<std::uint8_t>& second);

}  // namespace coslam
