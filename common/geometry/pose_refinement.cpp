// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/pose_refinement.h"

#include "common/geometry/levenberg_marquardt.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/geometry/robust.h"
#include "common/geometry/triangulation.h"

namespace coslam {
namespace {

constexpr int kMinPoints = 6;
constexpr double kMinPivot = 1e-10;  // of the scaled normal equations; a true degeneracy leaves rounding errors

struct Residual {
  Eigen::Vector2d r = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 6> j;
  Eigen::Matrix2d point_part = Eigen::Matrix2d::Zero();  // J Sigma J^T
  bool valid = false, far = false;
};

// What does not depend on the pose.
struct Given {
  Given(std::span<const RigView> cameras, std::span<const PointObservation> seen) : rig(cameras), observations(seen) {
    cam_from_rig.reserve(rig.size());
    for (const RigView& v : rig) cam_from_rig.emplace_back(v.cam_from_rig.rotation.toRotationMatrix());
    raw_by_undistorted.reserve(observations.size());
    for (const PointObservation& o : observations) {
      const CameraModel& camera = *rig[static_cast<std::size_t>(o.camera)].camera;
      raw_by_undistorted.emplace_back(camera.raw_by_undistorted(o.undistorted_px));
    }
  }
  std::span<const RigView> rig;
  std::span<const PointObservation> observations;
  std::vector<Eigen::Matrix3d> cam_from_rig;        // of each view of the rig
  std::vector<Eigen::Matrix2d> raw_by_undistorted;  // of each observation
};

// By the perturbation of retract(): x' = exp(w) x + t, so d x / d w = -[x]_x, d x / d t = I.
Residual residual_of(const Given& given, std::size_t i, const Rigid3& pose, const Eigen::Matrix3d& r) {
  const PointObservation& o = given.observations[i];
  const RigView& view = given.rig[static_cast<std::size_t>(o.camera)];
  const Eigen::Matrix3d& cam_from_rig = given.cam_from_rig[static_cast<std::size_t>(o.camera)];
  const Eigen::Matrix2d& raw = given.raw_by_undistorted[i];
  Residual out;
  out.far = o.far;
  const Eigen::Vector3d x = r * o.point_in_world + pose.translation;
  const Eigen::Vector3d in_cam = cam_from_rig * x + view.cam_from_rig.translation;
  if (in_cam.z() < 1e-6) return out;
  const Eigen::Matrix<double, 2, 3> p = raw * view.camera->project_jacobian(in_cam) * cam_from_rig;
  out.r = raw * (o.undistorted_px - view.camera->project(in_cam));
  out.j.leftCols<3>() = -p * skew(x);
  out.j.rightCols<3>() = p;
  const Eigen::Matrix<double, 2, 3> jp = p * r;
  out.point_part = jp * o.point_covariance * jp.transpose();
  // A point known worse than this in the image says nothing, and its covariance may be past the precision of its
  // numbers.
  constexpr double kUselessPx2 = 1e4;
  out.valid = out.point_part.diagonal().minCoeff() >= 0 && out.point_part.trace() < kUselessPx2;
  return out;
}

// What is not known of a far point grows with the way of the camera since it was seen. Were that weighed anew at each
// step, it would draw the camera back to where it grew from: the start says what a far point is worth.
void evaluate(const Given& given, const Rigid3& pose, const std::vector<Residual>& at_start,
              std::vector<Residual>* residuals) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  residuals->resize(given.observations.size());
  for (std::size_t i = 0; i < given.observations.size(); ++i) {
    (*residuals)[i] = residual_of(given, i, pose, r);
    if (given.observations[i].far && !at_start.empty()) (*residuals)[i].point_part = at_start[i].point_part;
  }
}

// Scale of the part of the residuals that the point covariances do not explain; of far points only without others.
double measured_sigma(const std::vector<Residual>& residuals, const PoseRefinementConfig& config, double cap_px) {
  std::vector<double> norms, explained;
  const bool near = std::ranges::count_if(residuals, [](const Residual& r) { return r.valid && !r.far; }) >= kMinPoints;
  for (const Residual& r : residuals) {
    if (!r.valid || (near && r.far)) continue;
    norms.push_back(r.r.norm());
    explained.push_back(0.5 * r.point_part.trace());
  }
  if (norms.empty()) return cap_px;
  const double total = robust_sigma_2d(norms);
  return std::clamp(std::sqrt(std::max(0.0, total * total - upper_median(explained))), config.sigma_floor_px, cap_px);
}

struct System {
  Matrix6d a = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double cost = 0;
  int inliers = 0;
};

// Whitened residual norm against t = 3 (in standard deviations).
System build(const std::vector<Residual>& residuals, double sigma_px, const std::optional<PosePrior>& prior,
             const Rigid3& pose, std::vector<bool>* is_inlier) {
  System s;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const Residual& r = residuals[i];
    (*is_inlier)[i] = false;
    if (!r.valid) {
      s.cost += tukey_rho(2 * kTukeyOfTwo, kTukeyOfTwo);
      continue;
    }
    const Eigen::Matrix2d information = (sigma_px * sigma_px * Eigen::Matrix2d::Identity() + r.point_part).inverse();
    const double d = std::sqrt(r.r.dot(information * r.r));
    const double w = tukey_weight(d, kTukeyOfTwo);
    s.cost += tukey_rho(d, kTukeyOfTwo);
    if (w <= 0) continue;
    (*is_inlier)[i] = true;
    ++s.inliers;
    const Eigen::Matrix<double, 6, 2> jw = r.j.transpose() * (w * information);
    s.a += jw * r.j;
    s.b += jw * r.r;
  }
  if (prior) {
    const PriorTerm term = prior_term(*prior, pose);
    s.a += term.a;
    s.b += term.b;
    s.cost += term.cost;
  }
  return s;
}

// What follows from the last step: covariance, or why there is none.
void conclude(const System& s, double sigma, PoseResult* out) {
  PoseResult& result = *out;
  result.sigma_px = sigma;
  result.inliers = s.inliers;
  if (s.inliers < kMinPoints) {
    result.status = PoseStatus::kTooFewInliers;
    return;
  }
  // Scaled to a unit diagonal, so that the test does not depend on the units of angle and length.
  const Vector6d scale = s.a.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Matrix6d> ldlt(scale.asDiagonal() * s.a * scale.asDiagonal());
  if (!scale.allFinite() || ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > kMinPivot)) {
    result.status = PoseStatus::kDegenerate;
    return;
  }
  result.covariance = scale.asDiagonal() * ldlt.solve(Matrix6d::Identity()) * scale.asDiagonal();
  result.status = result.covariance.allFinite() ? PoseStatus::kOk : PoseStatus::kDegenerate;
}

}  // namespace

PoseResult refine_pose(const CameraModel& camera, std::span<const PointObservation> observations, const Rigid3& initial,
                       const PoseRefinementConfig& config) {
  const RigView alone[] = {{&camera, Rigid3()}};
  return refine_rig_pose(alone, observations, initial, config);
}

PoseResult refine_rig_pose(std::span<const RigView> rig, std::span<const PointObservation> observations,
                           const Rigid3& initial, const PoseRefinementConfig& config) {
  PoseResult result;
  result.cam_from_world = initial;
  result.is_inlier.assign(observations.size(), false);
  if (observations.size() < kMinPoints) return result;

  std::vector<Residual> residuals;
  // The start may be far off (a fast turn): the scale follows the residuals down freely, and the bound holds at the
  // end.
  double cap_px = 1e9;
  const Given given(rig, observations);
  evaluate(given, result.cam_from_world, {}, &residuals);
  const std::vector<Residual> at_start = residuals;
  double sigma = measured_sigma(residuals, config, cap_px);
  System s = build(residuals, sigma, config.prior, result.cam_from_world, &result.is_inlier);
  // A start from the frame before is near. Beyond 1e4 nothing helps six unknowns.
  const Damping damping{.first = 1e-6, .most = std::nextafter(1e4, 1e5), .after_failure = 1e-4};
  levenberg_marquardt(damping, config.max_iterations, [&](double lambda) {
    if (s.inliers < kMinPoints) return LmStep::kImpossible;
    ++result.iterations;
    Matrix6d a = s.a;
    a.diagonal() *= 1.0 + lambda;
    const Vector6d step = a.ldlt().solve(s.b);
    if (!step.allFinite()) return LmStep::kImpossible;
    const Rigid3 candidate = retract(result.cam_from_world, step);
    std::vector<Residual> next;
    evaluate(given, candidate, at_start, &next);
    std::vector<bool> next_inlier(observations.size());
    const System t = build(next, sigma, config.prior, candidate, &next_inlier);
    if (t.cost > s.cost * (1 + 1e-9)) return LmStep::kFailed;
    result.cam_from_world = candidate;
    residuals.swap(next);
    const double improved = s.cost - t.cost;
    const double new_sigma = measured_sigma(residuals, config, cap_px);
    const bool settled = improved < 1e-4 * s.cost && std::abs(new_sigma - sigma) < 0.02 * sigma;
    sigma = new_sigma;
    s = build(residuals, sigma, config.prior, result.cam_from_world, &result.is_inlier);
    if (settled && sigma <= config.sigma_px) return LmStep::kConverged;
    if (settled) cap_px = config.sigma_px;
    return LmStep::kImproved;
  });
  if (sigma > config.sigma_px) {
    sigma = config.sigma_px;
    s = build(residuals, sigma, config.prior, result.cam_from_world, &result.is_inlier);
  }

  conclude(s, sigma, &result);
  return result;
}

double hull_fraction(std::vector<Eigen::Vector2d> p, const CameraModel& camera) {
  if (p.size() < 3) return 0.0;
  std::sort(p.begin(), p.end(),
            [](const auto& a, const auto& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  const auto turn = [](const Eigen::Vector2d& o, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
  };
  std::vector<Eigen::Vector2d> hull;  // Andrew's monotone chain: lower hull, then upper
  for (int side = 0; side < 2; ++side) {
    const std::size_t base = hull.size();
    for (const Eigen::Vector2d& q : p) {
      while (hull.size() >= base + 2 && turn(hull[hull.size() - 2], hull.back(), q) <= 0) hull.pop_back();
      hull.push_back(q);
    }
    hull.pop_back();
    std::reverse(p.begin(), p.end());
  }
  double twice_area = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d &a = hull[i], &b = hull[(i + 1) % hull.size()];
    twice_area += a.x() * b.y() - b.x() * a.y();
  }
  return std::min(1.0, 0.5 * std::abs(twice_area) / (static_cast<double>(camera.width_px) * camera.height_px));
}

}  // namespace coslam
