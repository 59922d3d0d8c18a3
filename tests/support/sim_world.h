// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"
#include "common/model/track_frame.h"

// The synthetic world of all tests: points with exact places in a room, and cameras on exact smooth paths. World axes
// are those of a camera at rest: x right, y down, z forward; metres.
namespace coslam::test {

using Patch = std::array<std::uint8_t, kPatchBytes>;
using Descriptor = std::array<std::uint8_t, kDescriptorBytes>;
using CameraPath = std::function<Rigid3(double t_s)>;  // cam_from_world

enum class Layout { kRoom, kPlane, kAround };

struct WorldConfig {
  unsigned seed = 1;
  Layout layout = Layout::kRoom;  // kPlane: all points on one wall, seen at a slant; kAround: 3 to 8 m away on
                                  // all sides
  int points = 450;
  int moving_points = 0;  // the last ones, on bodies of 25 points that do not turn; each body on a circle of its own
};

// Immutable after construction.
class SimWorld {
 public:
  explicit SimWorld(const WorldConfig& config);

  int size() const { return static_cast<int>(points_.size()); }
  bool moves(int point) const { return points_[static_cast<std::size_t>(point)].radius_m > 0; }
  Eigen::Vector3d position(int point, TimeNs t_ns = 0) const;
  const Descriptor& descriptor(int point) const { return points_[static_cast<std::size_t>(point)].descriptor; }
  // What a camera sees around a point: every point is the middle of a textured disc that faces the origin of the world.
  Patch patch(int point, const CameraModel& camera, const Rigid3& cam_from_world, TimeNs t_ns = 0) const;
  // The same from the origin.
  Patch patch(int point) const;

 private:
  struct Point {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    double radius_m = 0, rate_rad_s = 0, phase_rad = 0;
    Descriptor descriptor{};
    struct Ripple {
      Eigen::Vector2d rad_px = Eigen::Vector2d::Zero();  // at the size that a patch has from the origin
      double phase_rad = 0;
    };
    std::array<Ripple, 12> texture;
  };
  std::vector<Point> points_;
};

// 640 x 480, 75 degrees wide; the estimator sees undistorted pixels only.
CameraModel sim_camera();

// A camera at `center_m` that looks along z, turned by yaw (to the right) and pitch (up).
Rigid3 looking(const Eigen::Vector3d& center_m, double yaw_rad = 0, double pitch_rad = 0);

// Corners of a printed tag that faces a camera at rest, clockwise from its upper left one.
std::array<Eigen::Vector3d, 4> tag_corners(const Eigen::Vector3d& middle_m, double side_m);

struct Wave {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d amplitude_m = {1.2, 0.2, 0.3};
  double period_s = 6;
  double yaw_rad = 0, yaw_sweep_rad = 0.25;
};
// A smooth closed path; about 5 m long for each period of the default.
CameraPath wave_path(const Wave& wave);
CameraPath still_path(const Rigid3& cam_from_world);

// Side by side, on waves out of step, all looking into the room.
std::vector<CameraPath> paths_side_by_side(int cameras);

}  // namespace coslam::test
