// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/adjust/lens.h"

#include <Eigen/Cholesky>
#include <cstdio>
#include <cstdlib>

namespace coslam {
namespace {

// Squared distance from the calibration in standard deviations, six degrees of freedom: chance is as far off once in
// ten thousand times.
constexpr double kFound2 = 28;

}  // namespace

Vector6d calibration_sigma(const CameraModel& camera) {
  constexpr double kFocal = 0.005, kCentre = 0.005, kRadial = 0.02, kAspect = 0.002;
  Vector6d out;
  out << kFocal, kCentre * camera.width_px, kCentre * camera.width_px, kRadial, kRadial, kAspect;
  return out;
}

void free_lenses(const Map& map, RefineJob* job) {
  job->lens_noise = map.config().covariance_sigma_factor;
  for (const MapCamera& c : map.cameras()) {
    // What observations share makes them worth less than they say, see MapConfig: beside them a calibration is worth
    // more.
    job->problem.lenses.push_back({c.lens, calibration_sigma(c.model) / job->lens_noise, true});
  }
  for (auto& o : job->problem.observations) {
    const MapCamera& c = map.camera(job->poses[static_cast<std::size_t>(o.pose)].camera);
    const auto px = c.lens.calibrated_from_undistorted(c.model, o.undistorted_px);
    if (px) {
      o.undistorted_px = *px;
    } else {
      o.weight = 0;
    }
  }
}

BundleResult solve_with_lenses(const RefineJob& job) {
  BundleResult result = solve_bundle(job.problem, job.config);
  if (!result.usable || result.lens_covariances.empty()) return result;
  BundleProblem again = job.problem;
  bool given = false;
  for (std::size_t i = 0; i < again.lenses.size(); ++i) {
    auto& lens = again.lenses[i];
    if (!lens.free || !lens.start.none()) continue;
    const Vector6d& off = result.lenses[i].values;
    const Matrix6d covariance = job.lens_noise * job.lens_noise * result.lens_covariances[i];
    const double off2 = off.dot(covariance.ldlt().solve(off));
    if (std::getenv("COSLAM_LENS") != nullptr) {
      const Vector6d s = covariance.diagonal().cwiseSqrt();
      std::fprintf(stderr, "lens %zu poses %zu: off2 %.1f f %.4f+-%.4f c %.1f+-%.1f %.1f+-%.1f k1 %.4f+-%.4f k2 %.4f+-%.4f a %.4f+-%.4f\n", i,
                   job.poses.size(), off2, off[0], s[0], off[1], s[1], off[2], s[2], off[3], s[3], off[4], s[4], off[5], s[5]);
    }
    const bool found = off2 > kFound2 && is_invertible(again.cameras[i], result.lenses[i]);
    if (found) {
      lens.start = result.lenses[i];
    } else {
      lens.free = false;
      given = true;
    }
  }
  if (!given) return result;
  for (std::size_t i = 0; i < again.poses.size(); ++i) again.poses[i].cam_from_world = result.poses[i];
  again.points = result.points;
  return solve_bundle(again, job.config);
}

int take_lenses(MapEdit& edit, const RefineJob& job, const BundleResult& result) {
  int changed = 0;
  for (std::size_t i = 0; i < result.lenses.size(); ++i) {
    const MapCamera& c = edit.map().camera(CameraId(static_cast<std::uint16_t>(i)));
    // Its agent may have come back with another calibration.
    const bool same = c.model == job.problem.cameras[i] && c.lens == job.problem.lenses[i].start;
    if (!same || result.lenses[i] == c.lens || !is_invertible(c.model, result.lenses[i])) continue;
    edit.correct_lens(c, result.lenses[i]);
    ++changed;
  }
  return changed;
}

}  // namespace coslam
