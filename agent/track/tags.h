// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "agent/track/aruco.h"
#include "common/base/ids.h"
#include "common/geometry/camera_model.h"

namespace coslam {

inline constexpr const char* kNoTags = "none";

struct TagConfig {
  std::string family = kNoTags;  // name of the family in OpenCV, see tag_families()
  double period_s = 0.2;         // between images that are searched: a search takes as long as several tracking steps
};

// "none" and those that are known. The more bits, the less else is taken for a tag.
std::vector<std::string> tag_families();

struct FoundTag {
  TagId tag;
  std::array<Eigen::Vector2d, 4>
      undistorted_px;   // corners of the black square, clockwise as printed from the upper left
  int edges = 0;        // places on edges that the corners rest on
  double error_px = 0;  // RMS distance of these places from the fitted edges
};

// Printed square tags in an image. OpenCV finds and reads them; then the plane is fitted to all their edges, those of
// the bits included, in undistorted pixels: 0.05 px at the corners, where contours give half a pixel. Gamma, blur and
// ink make the black parts smaller or larger than they are; since edges of both senses are seen that is found and taken
// out.
class TagFinder {
 public:
  // Throws UserError for an unknown family.
  TagFinder(const CameraModel& camera, const std::string& family);

  // Ascending tag. A tag that is partly hidden, blurred or bent is left out; one that is printed twice is there twice.
  std::vector<FoundTag> find(const cv::Mat& grey) const;

 private:
  CameraModel camera_;
  aruco::Dictionary dictionary_;
  aruco::Parameters parameters_;
};

}  // namespace coslam
