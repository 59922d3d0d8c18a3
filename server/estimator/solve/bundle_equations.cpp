// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/bundle_equations.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/estimator/solve/reprojection.h"

namespace coslam {

BundleEstimate start_of(const BundleProblem& problem) {
  BundleEstimate e;
  for (const auto& p : problem.poses) {
    e.poses.push_back(p.cam_from_world);
    if (!p.fixed) e.poses.back().rotation.normalize();
    e.rotations.emplace_back(e.poses.back().rotation.toRotationMatrix());
  }
  e.points = problem.points;
  for (std::size_t i = 0; i < problem.lenses.size(); ++i) {
    e.lenses.emplace_back(problem.cameras[i], problem.lenses[i].start);
  }
  for (const auto& zoom : problem.zooms) e.zooms.push_back(zoom ? zoom->start : 0);
  return e;
}

namespace {

using ByLens = Eigen::Matrix<double, 2, LensCorrection::kTerms>;

// An observation in the raw image as it would be without zoom, with its standard deviation there.
struct RawObservation {
  Eigen::Vector2d px;
  double sigma_px = 1;
  Eigen::Vector2d from_centre;  // in the image as it is, in standard deviations
};

RawObservation raw_observation(const BundleProblem& problem, const BundleStructure& s, const BundleEstimate& e,
                               std::size_t i) {
  const auto& o = problem.observations[i];
  if (e.zooms.empty()) return {s.raw_px[i], o.sigma_px, {}};
  const auto camera_index = at(problem.poses[at(o.pose)].camera);
  const CameraModel& camera = problem.cameras[camera_index];
  const Eigen::Vector2d centre = Eigen::Vector2d(camera.cx, camera.cy) + e.lenses[camera_index].lens().centre_px();
  const double shrink = std::exp(-e.zooms[at(o.pose)]);
  const Eigen::Vector2d off = s.raw_px[i] - centre;
  return {centre + shrink * off, shrink * o.sigma_px, off / o.sigma_px};
}

// What the walk says of zooms: visit(pose, pose before or -1, difference, weight).
void each_zoom_term(const BundleProblem& problem, const BundleEstimate& e, auto&& visit) {
  for (std::size_t i = 0; i < problem.zooms.size(); ++i) {
    if (!problem.zooms[i]) continue;
    const BundleProblem::Zoom& z = *problem.zooms[i];
    const auto whole = [&](std::size_t pose) { return problem.zooms[pose]->taken_out + e.zooms[pose]; };
    visit(i, -1, whole(i), 1 / (z.prior_sigma * z.prior_sigma));
    if (z.before >= 0) visit(i, z.before, whole(i) - whole(at(z.before)), 1 / (z.step_sigma * z.step_sigma));
  }
}

// What the calibration says of a lens: its part of the cost (twice), of the diagonal and of the gradient.
struct LensPriorTerm {
  double cost = 0;
  LensCorrection::Values weights, gradient;
};

LensPriorTerm lens_prior(const BundleProblem::Lens& lens, const LensCorrection& now) {
  constexpr double kTailSigmas = 3;
  const BundleLoss loss(kTailSigmas);
  LensPriorTerm out;
  for (int i = 0; i < LensCorrection::kTerms; ++i) {
    const double weight = 1 / (lens.prior_sigma[i] * lens.prior_sigma[i]), d2 = weight * now.values[i] * now.values[i];
    out.cost += loss.value(d2);
    out.weights[i] = loss.slope(d2) * weight;
    out.gradient[i] = out.weights[i] * now.values[i];
  }
  return out;
}

}  // namespace

double cost_of(const BundleProblem& problem, const BundleStructure& s, const BundleLoss& loss,
               const BundleEstimate& e) {
  double cost = 0;
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto& o = problem.observations[i];
    const auto camera_index = at(problem.poses[at(o.pose)].camera);
    const Eigen::Vector3d x = e.rotations[at(o.pose)] * e.points[at(o.point)] + e.poses[at(o.pose)].translation;
    Eigen::Vector2d residual;
    if (e.lenses.empty()) {
      residual = reprojection_residual(problem.cameras[camera_index], s.whiten[i], o.undistorted_px, x);
    } else {
      const RawObservation raw = raw_observation(problem, s, e, i);
      residual = lens_reprojection_residual(e.lenses[camera_index], raw.px, raw.sigma_px, x);
    }
    cost += o.weight * loss.value(residual.squaredNorm());
  }
  for (std::size_t i = 0; i < problem.lenses.size(); ++i) {
    if (problem.lenses[i].free) cost += lens_prior(problem.lenses[i], e.lenses[i].lens()).cost;
  }
  each_zoom_term(problem, e, [&](std::size_t, int, double off, double weight) { cost += weight * off * off; });
  for (const auto& t : problem.ties) {
    cost += tie(t.second_from_first, e.poses[at(t.first)], e.poses[at(t.second)]).residual.squaredNorm();
  }
  return 0.5 * cost;
}

namespace {

// What the lenses' columns share with each other and with those of the poses.
class LensBlocks {
 public:
  explicit LensBlocks(const BundleProblem& problem)
      : with_pose_(problem.lenses.empty() ? 0 : problem.poses.size(), {Matrix6d::Zero(), Matrix6d::Zero()}),
        between_(problem.lenses.size(), Matrix6d::Zero()) {}

  void add(std::size_t camera, std::size_t pose, bool pose_is_free, double weight, const Reprojection& r,
           const ByLens& by_lens) {
    for (int half = 0; pose_is_free && half < BundleStructure::kHalves; ++half) {
      with_pose_[pose][at(half)].noalias() += weight * by_lens.middleCols<6>(6 * half).transpose() * r.by_pose;
    }
    between_[camera].noalias() += weight * by_lens.rightCols<6>().transpose() * by_lens.leftCols<6>();
  }

  void give(const BundleProblem& problem, const BundleStructure& s, const BundleEstimate& e, BundleSystem* out) const {
    for (std::size_t pose = 0; pose < with_pose_.size(); ++pose) {
      const int column = s.column_of[pose], lens = s.lens_column_of[at(problem.poses[pose].camera)];
      if (column < 0 || lens < 0 || s.links_at[at(column)].empty()) continue;
      for (int half = 0; half < BundleStructure::kHalves; ++half) {
        out->ties.emplace_back(std::pair(lens + half, column), with_pose_[pose][at(half)]);
      }
    }
    for (std::size_t i = 0; i < between_.size(); ++i) {
      const int column = s.lens_column_of[i];
      if (column < 0) continue;
      const LensPriorTerm prior = lens_prior(problem.lenses[i], e.lenses[i].lens());
      for (int half = 0; half < BundleStructure::kHalves; ++half) {
        out->columns[at(column + half)].diagonal() += prior.weights.segment<6>(6 * half);
        out->column_gradients[at(column + half)] += prior.gradient.segment<6>(6 * half);
      }
      if (!s.links_at[at(column)].empty()) out->ties.emplace_back(std::pair(column + 1, column), between_[i]);
    }
  }

 private:
  std::vector<std::array<Matrix6d, BundleStructure::kHalves>> with_pose_;
  std::vector<Matrix6d> between_;
};

// What the columns of zooms share with each other, with lenses and poses.
class ZoomBlocks {
 public:
  explicit ZoomBlocks(const BundleProblem& problem, const BundleStructure& s)
      : with_pose_(problem.zooms.size(), Vector6d::Zero()),
        with_lens_(problem.zooms.size(), ByTerms::Zero()),
        first_(s.columns) {
    for (const auto& place : s.zoom_of) {
      if (place.column >= 0) first_ = std::min(first_, place.column);
    }
  }
  // by_lens: nothing where the lens is given.
  void add(std::size_t pose, double weight, const Eigen::Vector2d& by_zoom, const Reprojection& r,
           const ByLens* by_lens) {
    with_pose_[pose].noalias() += weight * r.by_pose.transpose() * by_zoom;
    if (by_lens != nullptr) with_lens_[pose].noalias() += weight * by_lens->transpose() * by_zoom;
  }
  void give(const BundleProblem& problem, const BundleStructure& s, const BundleEstimate& e, BundleSystem* out) const {
    for (std::size_t i = 0; i < with_pose_.size(); ++i) {
      const BundleStructure::ZoomPlace place = s.zoom_of[i];
      if (place.column < 0 || s.links_at[at(place.column)].empty()) continue;
      const auto tie_with = [&](int other, const Vector6d& shared) {
        if (other < 0 || s.links_at[at(other)].empty()) return;
        Matrix6d block = Matrix6d::Zero();
        block.row(place.slot) = shared;
        out->ties.emplace_back(std::pair(place.column, other), block);
      };
      if (!with_pose_[i].isZero(0)) tie_with(s.column_of[i], with_pose_[i]);
      const int lens = s.lens_column_of[at(problem.poses[i].camera)];
      for (int half = 0; lens >= 0 && half < BundleStructure::kHalves && !with_lens_[i].isZero(0); ++half) {
        tie_with(lens + half, with_lens_[i].segment<6>(6 * half));
      }
    }
    each_zoom_term(problem, e, [&](std::size_t pose, int before, double off, double weight) {
      const auto [column, slot] = s.zoom_of[pose];
      out->columns[at(column)](slot, slot) += weight;
      out->column_gradients[at(column)][slot] += weight * off;
      if (before < 0) return;
      const auto [column_before, slot_before] = s.zoom_of[at(before)];
      out->columns[at(column_before)](slot_before, slot_before) += weight;
      out->column_gradients[at(column_before)][slot_before] -= weight * off;
      if (column_before == column) {
        out->columns[at(column)](slot, slot_before) -= weight;
        out->columns[at(column)](slot_before, slot) -= weight;
      } else {
        Matrix6d block = Matrix6d::Zero();
        if (column > column_before)
          block(slot, slot_before) = -weight;
        else
          block(slot_before, slot) = -weight;
        out->ties.emplace_back(std::pair(std::max(column, column_before), std::min(column, column_before)), block);
      }
    });
    // Places that no pose has.
    for (int column = first_; column < s.columns; ++column) {
      Matrix6d& block = out->columns[at(column)];
      for (int slot = 0; slot < BundleStructure::kZooms; ++slot) {
        if (block(slot, slot) == 0) block(slot, slot) = 1;
      }
    }
  }

 private:
  using ByTerms = Eigen::Matrix<double, LensCorrection::kTerms, 1>;
  std::vector<Vector6d> with_pose_;
  std::vector<ByTerms> with_lens_;
  int first_;  // column of zooms, which come last
};

void add_tie(const BundleProblem::Tie& t, const BundleStructure& s, const BundleEstimate& e, BundleSystem* out) {
  const Tie is = tie(t.second_from_first, e.poses[at(t.first)], e.poses[at(t.second)]);
  const int first = s.column_of[at(t.first)], second = s.column_of[at(t.second)];
  const auto add = [&](int column, const Matrix6d& derivative) {
    if (column < 0) return;
    out->columns[at(column)] += derivative.transpose() * derivative;
    out->column_gradients[at(column)] += derivative.transpose() * is.residual;
  };
  add(first, is.by_first);
  add(second, is.by_second);
  if (first < 0 || second < 0 || first == second) return;
  const Matrix6d block = is.by_second.transpose() * is.by_first;
  out->ties.emplace_back(std::pair(std::max(first, second), std::min(first, second)),
                         second > first ? block : Matrix6d(block.transpose()));
}

}  // namespace

BundleSystem system_around(const BundleProblem& problem, const BundleStructure& s, const BundleLoss& loss,
                           const BundleEstimate& e) {
  BundleSystem out{std::vector<Matrix6d>(at(s.columns), Matrix6d::Zero()),
                   std::vector<Vector6d>(at(s.columns), Vector6d::Zero()),
                   std::vector<Eigen::Matrix3d>(e.points.size(), Eigen::Matrix3d::Zero()),
                   std::vector<Eigen::Vector3d>(e.points.size(), Eigen::Vector3d::Zero()),
                   std::vector<Matrix63>(s.links.size(), Matrix63::Zero()),
                   {}};
  LensBlocks lens_blocks(problem);
  ZoomBlocks zoom_blocks(problem, s);
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto& o = problem.observations[i];
    const auto pose = at(o.pose), camera_index = at(problem.poses[pose].camera);
    ByLens by_lens;
    Reprojection r;
    Eigen::Vector2d by_zoom = Eigen::Vector2d::Zero();
    if (e.lenses.empty()) {
      r = reprojection(problem.cameras[camera_index], s.whiten[i], o.undistorted_px, e.rotations[pose],
                       e.poses[pose].translation, e.points[at(o.point)]);
    } else {
      const RawObservation raw = raw_observation(problem, s, e, i);
      r = lens_reprojection(e.lenses[camera_index], raw.px, raw.sigma_px, e.rotations[pose], e.poses[pose].translation,
                            e.points[at(o.point)], &by_lens);
      if (s.zoom_link_of[i] >= 0 && !r.by_point.isZero(0)) by_zoom = r.residual + raw.from_centre;
    }
    const double weight = o.weight * loss.slope(r.residual.squaredNorm());
    const Eigen::Matrix<double, 3, 2> by_point = weight * r.by_point.transpose();
    out.points[at(o.point)].noalias() += by_point.lazyProduct(r.by_point);
    out.point_gradients[at(o.point)].noalias() += by_point.lazyProduct(r.residual);
    const auto add = [&](int column, int link, const Eigen::Matrix<double, 2, 6>& derivative) {
      const Eigen::Matrix<double, 6, 2> weighted = weight * derivative.transpose();
      out.columns[at(column)].noalias() += weighted.lazyProduct(derivative);
      out.column_gradients[at(column)].noalias() += weighted.lazyProduct(r.residual);
      out.links[at(link)].noalias() += weighted.lazyProduct(r.by_point);
    };
    if (s.link_of[i] >= 0) add(s.column_of[pose], s.link_of[i], r.by_pose);
    if (s.zoom_link_of[i] >= 0) {
      const auto [column, slot] = s.zoom_of[pose];
      Eigen::Matrix<double, 2, 6> derivative = Eigen::Matrix<double, 2, 6>::Zero();
      derivative.col(slot) = by_zoom;
      add(column, s.zoom_link_of[i], derivative);
      zoom_blocks.add(pose, weight, by_zoom, r, s.lens_column_of[camera_index] >= 0 ? &by_lens : nullptr);
    }
    if (s.lens_column_of[camera_index] < 0) continue;
    for (int half = 0; half < BundleStructure::kHalves; ++half) {
      add(s.lens_column_of[camera_index] + half, s.lens_link_of[at(half)][i], by_lens.middleCols<6>(6 * half));
    }
    lens_blocks.add(camera_index, pose, s.link_of[i] >= 0, weight, r, by_lens);
  }
  lens_blocks.give(problem, s, e, &out);
  zoom_blocks.give(problem, s, e, &out);
  for (const auto& t : problem.ties) add_tie(t, s, e, &out);
  return out;
}

}  // namespace coslam
