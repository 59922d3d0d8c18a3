// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/keys.h"

namespace coslam {

struct VerifyConfig {
  double prove_s = 0.67;  // time inside the gate that proves a point of one camera; of several: half as long
};

template <class V>
void describe(V& v, VerifyConfig& c) {
  v.field("prove_s", c.prove_s, {0.01, 100}, "inside the gate proves a point of one camera");
}

struct VerifyReport {
  int inside = 0, outside = 0, updated = 0;

  void count(auto&& add) const {
    add("gate_inside", inside);
    add("gate_outside", outside);
    add("filter_updates", updated);
  }
};

// Checks every new observation of a bound static point against its prediction: gate theta on r^T (J Sigma J^T + sigma^2
// I)^-1 r (8). Inside: Kalman update (5)-(7) of a proven point once the ray has turned far enough, since observations
// of one track are correlated in time. A patch that came with this set becomes the point's. Outside: one more failure
// of the track; classify() decides what follows from it.
VerifyReport verify(VerifyEdit& edit, const FrameSet& set, const VerifyConfig& config);

struct PointEstimate {
  Eigen::Vector3d position;
  Eigen::Matrix3d covariance;
};

// Kalman update (5)-(7) in Joseph form; sigma_px: standard deviation of one coordinate of the observation.
PointEstimate kalman_update(const MapPoint& point, const CameraModel& camera, const Rigid3& cam_from_world,
                            const Eigen::Vector2d& undistorted_px, double sigma_px);

// Squared Mahalanobis distance (8) of an observation; empty when the point is not in front of the camera.
std::optional<double> gate_distance2(const PointEstimate& point, const CameraModel& camera,
                                     const Rigid3& cam_from_world, const Eigen::Vector2d& undistorted_px,
                                     double sigma_px);

// Tells whether a point explains what was seen in the past: every view within theta of it. False without any view.
bool explains(const PointEstimate& point, const std::vector<View>& past, double sigma_px, double theta);
// Tells whether a point explains what a track saw in the last check_back_s.
bool explains_past(const Map& map, const MapCamera& camera, const ServerTrack& track, const PointEstimate& point);
// Returns the newest views of a track, newest first, at most `most`: as far back as the track is trusted, or all.
enum class Past : std::uint8_t { kTrusted, kAll };
std::vector<View> newest_views(const MapCamera& camera, const ServerTrack& track, std::size_t most, Past past);

struct Verify {
  static constexpr std::string_view kName = "verify";
  using Config = VerifyConfig;
  Config config;
  VerifyReport run(VerifyEdit& edit, const FrameSet& set) const { return verify(edit, set, config); }
};

}  // namespace coslam
