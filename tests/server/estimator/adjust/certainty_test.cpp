// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/certainty.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/geometry/alignment.h"
#include "server/estimator/adjust/bundle_adjustment.h"
#include "tests/server/estimator/adjust/drifted_map.h"
#include "tests/support/sim_map.h"

namespace coslam::certainty_test {
namespace {

class CertaintyTest : public RefineTest {
 protected:
  CertaintyTest() : job_(plan(RefineExtent::kWhole)), result_(solve_refine(job_)) {}
  void set_errors(int point, double error_px) {
    for (std::size_t i = 0; i < job_.observations.size(); ++i) {
      if (job_.problem.observations[i].point != point) continue;
      result_.errors_px[i] = error_px;
      result_.is_inlier[i] = std::isfinite(error_px);
    }
  }
  double views(int point) const {
    return static_cast<double>(
        std::ranges::count(job_.problem.observations, point, &BundleProblem::Observation::point));
  }

  RefineJob job_;
  BundleResult result_;
};

TEST_F(CertaintyTest, TracksThatSlideAreWorthLessByTheirOwnResiduals) {
  const double noise_px = sim_.map.camera(cam(0)).sigma_px;
  const double unit_px = sim_.map.covariance_sigma_px(sim_.map.camera(cam(0)));
  for (const MapCamera& c : sim_.map.cameras()) ASSERT_EQ(c.sigma_px, noise_px);
  set_errors(0, 0);
  set_errors(1, 1.5);
  set_errors(2, std::numeric_limits<double>::infinity());
  const std::vector<double> variances = track_variances(sim_.map, job_, result_);
  ASSERT_EQ(variances.size(), job_.points.size());
  const auto expected = [&](int point, double error_px) {
    const double n = views(point);
    const double residual2 = (3 * noise_px * noise_px + n * error_px * error_px) / (3 + 2 * n - 3);
    return (noise_px * noise_px + 4 * residual2) / (unit_px * unit_px);
  };
  EXPECT_NEAR(variances[0], expected(0, 0), 1e-9);
  EXPECT_NEAR(variances[1], expected(1, 1.5), 1e-9);
  EXPECT_EQ(variances[2], 1) << "nothing is known of it";
}

TEST_F(CertaintyTest, NoPointIsSurerThanItsOwnTracksAllow) {
  ASSERT_TRUE(apply_refine(sim_.edit, job_, result_).applied);
  const std::vector<double> variances = track_variances(sim_.map, job_, result_);
  std::vector<Eigen::Matrix3d> own;
  for (const PointId id : job_.points) {
    const MapPoint* p = sim_.map.find(id);
    own.push_back(p == nullptr ? Eigen::Matrix3d::Zero().eval() : p->covariance);
  }
  settle_covariances(sim_.edit, job_, result_);
  for (std::size_t i = 0; i < own.size(); ++i) {
    const MapPoint* p = sim_.map.find(job_.points[i]);
    if (p == nullptr) continue;
    EXPECT_GE(p->covariance.trace(), variances[i] * own[i].trace() * (1 - 1e-9)) << "poses only add";
  }
}

TEST_F(CertaintyTest, AnAdjustedMapKnowsHowGoodItIs) {
  adjust_whole(sim_.edit, sim_.id, config_);
  std::vector<Eigen::Vector3d> found, truth;
  for (const auto& [id, p] : sim_.map.points()) {
    if (const int point = sim_.world_point(p); point >= 0 && !p.bound.empty()) {
      found.push_back(p.position);
      truth.push_back(world_.position(point));
    }
  }
  const Alignment to_truth = align_points(found, truth, AlignmentScale::kFree);
  ASSERT_TRUE(to_truth.target_from_source);
  const Eigen::Matrix3d linear =
      to_truth.target_from_source->scale * to_truth.target_from_source->rotation.toRotationMatrix();
  std::vector<double> values;
  for (const auto& [id, p] : sim_.map.points()) {
    const int point = sim_.world_point(p);
    if (point < 0 || p.bound.empty() || p.key_observations.size() < 6) continue;
    values.push_back(test::nees(*to_truth.target_from_source * p.position - world_.position(point),
                                linear * p.covariance * linear.transpose()));
  }
  EXPECT_GT(values.size(), 100U);
  EXPECT_LT(test::median(values), 4);
  EXPECT_GT(test::median(values), 0.05) << "noise of each view alone averages out, which is not counted on";
}

}  // namespace
}  // namespace coslam::certainty_test
