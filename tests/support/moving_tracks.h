// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/support/wire_values.h"

namespace coslam::test {

// Frames of a camera that turns and moves among points 2 to 10 m away, as a tracker would give them: noise of 0.3 px,
// 2 % of the tracks lost with each frame, new ones for all that are lost or leave the image.
class MovingTracks {
 public:
  MovingTracks(const CameraModel& camera, double rate_hz, int tracks, std::uint64_t seed = 1)
      : camera_(camera), rate_hz_(rate_hz), count_(static_cast<std::size_t>(tracks)), values_(seed) {}

  TrackFrame next() {
    TrackFrame frame = values_.frame("cam0", RunId(9), number_, 0);
    frame.capture_ns = static_cast<TimeNs>(1e9 * number_ / rate_hz_);
    frame.tags.clear();
    const double t_s = ++number_ / rate_hz_;
    // Up to 0.6 rad/s and 1 m/s.
    const Eigen::Vector3d turn(0.3 * std::sin(t_s), 0.5 * std::sin(0.9 * t_s), 0.2 * std::sin(1.1 * t_s));
    const Eigen::Vector3d move(std::sin(t_s), 0.3 * std::sin(1.7 * t_s), 0.5 * std::sin(0.7 * t_s));
    Vector6d change;
    change << turn, move;
    cam_from_world_ = retract({}, change);
    std::erase_if(alive_, [&](const Alive& a) { return values_.below(50) == 0 || !inside(project(a)); });
    while (alive_.size() < count_) alive_.push_back(born());
    for (const Alive& a : alive_) {
      const double noise_y = values_.uniform(-0.52, 0.52), noise_x = values_.uniform(-0.52, 0.52);
      frame.tracks.push_back(
          {a.track, quantised_px(project(a) + Eigen::Vector2d(noise_x, noise_y), pixel_scale(camera_))});
    }
    return frame;
  }

  std::vector<TrackFrame> next(int frames) {
    std::vector<TrackFrame> all;
    for (int i = 0; i < frames; ++i) all.push_back(next());
    return all;
  }

 private:
  struct Alive {
    TrackId track;
    Eigen::Vector3d in_world;
  };

  Eigen::Vector2d project(const Alive& a) const {
    const Eigen::Vector3d p = cam_from_world_ * a.in_world;
    if (p.z() < 0.1) return {-1, -1};
    return {camera_.fx * p.x() / p.z() + camera_.cx, camera_.fy * p.y() / p.z() + camera_.cy};
  }
  bool inside(const Eigen::Vector2d& px) const {
    return px.x() >= 0 && px.y() >= 0 && px.x() < camera_.width_px && px.y() < camera_.height_px;
  }
  Alive born() {
    const double depth_m = values_.uniform(2, 10);
    const double y_px = values_.uniform(0, camera_.height_px), x_px = values_.uniform(0, camera_.width_px);
    const Eigen::Vector3d ray((x_px - camera_.cx) / camera_.fx, (y_px - camera_.cy) / camera_.fy, 1);
    track_ += 1 + values_.below(3);  // some live for one frame only
    return {TrackId(track_), cam_from_world_.inverse() * Eigen::Vector3d(depth_m * ray)};
  }

  const CameraModel camera_;
  const double rate_hz_;
  const std::size_t count_;
  WireValues values_;
  Rigid3 cam_from_world_;
  std::vector<Alive> alive_;  // ascending
  std::uint32_t number_ = 0, track_ = 0;
};

inline CameraModel hd_camera() {
  CameraModel camera = vga_camera();
  camera.width_px = 1920;
  camera.height_px = 1080;
  camera.fx = camera.fy = 1400;
  camera.cx = 959.5;
  camera.cy = 539.5;
  return camera;
}

}  // namespace coslam::test
