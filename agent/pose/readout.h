// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/geometry/camera_model.h"

namespace coslam {

// A track in one image.
struct SeenPlace {
  TrackId track;
  double raw_row_px = 0;
  Eigen::Vector2d undistorted_px = Eigen::Vector2d::Zero();
};

// Estimates the time from a camera's first row to its last, from its tracks while it turns. A camera that turns by w in
// a second sees at row r, read t(r) = (r / height - 1/2) readout after the middle one, exp(w t(r)) n instead of n.
// Between two images with different w, that is
//   m_2 = R m_1 + readout [ t_2 w_2 x m_2 - R (t_1 w_1 x m_1) ] + turn x m_2 - way across m_2,
// with t(r) of a readout of one second: linear in the readout, and in what is left of the turn R and the way of the
// camera, in depths of the scene, which are found with it. One pair of images tells little, many together do; how they
// differ says how sure they are. Thread-compatible.
class ReadoutEstimate {
 public:
  explicit ReadoutEstimate(const CameraModel& camera) : camera_(camera) {}

  // The next image, its places as they were seen.
  void take(TimeNs capture_ns, const std::vector<SeenPlace>& places);
  // The turn of the camera between the newest two images, over the time between them.
  std::optional<Eigen::Vector3d> turn_rad_s() const;

  // 0 as long as it may well be 0.
  double readout_s() const { return readout_s_; }

 private:
  struct Seen {
    Eigen::Vector3d direction;
    double late = 0;  // time in units of the readout, -1/2 at the first row
  };
  struct SeenImage {
    TimeNs capture_ns = 0;
    std::unordered_map<TrackId, Seen> seen;
    std::optional<Eigen::Vector3d> since_rad_s;  // turn since the image before
    std::optional<Eigen::Vector3d> turn_rad_s;   // at its instant
  };
  void measure_turns(SeenImage* now);
  void compare(const SeenImage& first, const SeenImage& second);
  void take(double readout_s, double variance_s2);

  CameraModel camera_;
  std::deque<SeenImage> images_;
  double seen_s_ = 0;  // since the first image
  int intervals_ = 0;  // since then
  double readout_s_ = 0;
  double information_ = 0, weighted_s_ = 0, squares_s2_ = 0, pairs_ = 0;
};

}  // namespace coslam
