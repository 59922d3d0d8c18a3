// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "common/model/map_patch.h"
#include "common/model/session.h"
#include "common/model/track_frame.h"

namespace coslam {

double pixel_scale(const CameraModel& camera) {
  // Undistorted coordinates may lie outside the image: leave room for twice its size on either side.
  const double reach_px = 2.0 * std::max(camera.width_px, camera.height_px);
  return std::exp2(std::floor(std::log2(32767.0 / reach_px)));
}

Eigen::Vector2f quantised_px(const Eigen::Vector2d& undistorted_px, double scale) {
  const auto grid = [scale](double v) {
    // + 0.0 makes 0 of -0, which int16 cannot carry.
    return static_cast<float>(std::round(std::clamp(v * scale, -32767.0, 32767.0)) / scale + 0.0);
  };
  return {grid(undistorted_px.x()), grid(undistorted_px.y())};
}

std::vector<TrackObservation> seen_through(const CameraModel& camera, const LensCorrection& lens,
                                           const std::vector<TrackObservation>& tracks) {
  if (lens.none()) return tracks;
  const CorrectedLens corrected(camera, lens);
  std::vector<TrackObservation> out;
  out.reserve(tracks.size());
  for (const TrackObservation& o : tracks) {
    const auto px = corrected.undistorted_from_calibrated(o.undistorted_px.cast<double>());
    if (px) out.push_back({o.track, px->cast<float>()});
  }
  return out;
}

std::uint8_t descriptor_step(std::uint8_t value) {
  return static_cast<std::uint8_t>(std::min(15.0, std::round(std::sqrt(static_cast<double>(value)))));
}

int patch_shift(const PatchGrey& grey) {
  const auto [low, high] = std::minmax_element(grey.begin(), grey.end());
  int shift = 0;
  while ((*high >> shift) - (*low >> shift) >= kPatchSteps) ++shift;
  return shift;
}

PatchGrey quantised_patch(const PatchGrey& grey) {
  const int shift = patch_shift(grey);
  PatchGrey out;
  std::transform(grey.begin(), grey.end(), out.begin(), [shift](std::uint8_t v) {
    return static_cast<std::uint8_t>(((v >> shift) << shift) | ((1 << shift) >> 1));
  });
  return out;
}

Eigen::Matrix3d unpack_covariance(const Eigen::Matrix<float, 6, 1>& p) {
  Eigen::Matrix3d m;
  m << p[0], p[1], p[2], p[1], p[3], p[4], p[2], p[4], p[5];
  return m;
}

Eigen::Matrix<float, 6, 1> pack_covariance(const Eigen::Matrix3d& c) {
  Eigen::Matrix<double, 6, 1> p;
  p << c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2);
  return p.cast<float>();
}

std::optional<std::string> refusal_of(const ServerStatus& status, RunId agent_run) {
  for (const Refusal& refusal : status.refused) {
    if (refusal.agent_run == agent_run) return refusal.reason;
  }
  return std::nullopt;
}

}  // namespace coslam
