// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/offline_loops.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "tests/support/map_checks.h"
#include "tests/support/map_fit.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::offline_loops_test {
namespace {

using test::cam;
using test::PoseNear;

constexpr int kRound = 300;  // sets, ten seconds

// Turns once around while it drifts, and sees again what it saw at first: by new tracks, which become new points.
class OfflineLoopsTest : public testing::Test {
 protected:
  // Images are remembered at the first two of these sets and at the others, of the second visit.
  void fly(const test::SimWorld& world, const Similarity3& drift, const std::vector<int>& remembered) {
    sim_.emplace(
        world, std::vector<test::CameraPath>{[](double t_s) {
          return test::looking({0.3 * std::sin(0.35 * std::numbers::pi * t_s), 0, 0}, 0.2 * std::numbers::pi * t_s);
        }});
    for (int i = 0; i <= kRound + 10; ++i) {
      const bool described = std::ranges::find(remembered, i) != remembered.end();
      sim_->ingest(false, described);
      const double share = std::min(1.0, static_cast<double>(i) / kRound);
      drift_ = {std::pow(drift.scale, share), Eigen::Quaterniond::Identity().slerp(share, drift.rotation),
                share * drift.translation};
      sim_->place(cam(0), transform_world(truth(i), drift_));
      if (i == 0 || i == kRound) add_points();
      if (i == 0) first_points_ = static_cast<int>(sim_->map.points().size());
      if (!described) continue;
      const DescriptorReply& whole = *sim_->set.frames[0].descriptors;
      places_.add(sim_->edit, newest_image(sim_->map.camera(cam(0))), thirds_ && i >= kRound ? third_of(whole) : whole);
    }
    test::forget(sim_->edit.journal());
  }
  // Another third of the world's points each time.
  DescriptorReply third_of(const DescriptorReply& whole) {
    DescriptorReply out{whole.agent, whole.agent_run, whole.frame, {}, {}};
    for (std::size_t i = 0; i < whole.tracks.size(); ++i) {
      if (sim_->world_point(cam(0), whole.tracks[i]) % 3 != next_third_) continue;
      out.tracks.push_back(whole.tracks[i]);
      const auto begin = whole.descriptors.begin() + static_cast<std::ptrdiff_t>(i * kDescriptorBytes);
      out.descriptors.insert(out.descriptors.end(), begin, begin + kDescriptorBytes);
    }
    next_third_ = (next_third_ + 1) % 3;
    return out;
  }
  // Of all that is seen and has none, where the map has drifted to.
  void add_points() {
    for (int p = 0; p < sim_->world.size(); ++p) {
      const ServerTrack* t = sim_->track_of(cam(0), p);
      if (t != nullptr && !t->bound()) sim_->bind(sim_->create(drift_ * sim_->world.position(p)), cam(0), *t);
    }
  }
  OfflineLoopsReport look(int min_inliers = 25) {
    const OfflineLoopsReport report = close_loops_offline(sim_->edit, places_, sim_->id, min_inliers, &loops_);
    test::expect_consistent(sim_->map);
    return report;
  }
  Rigid3 truth(int set) const { return sim_->truth(cam(0), SetId(static_cast<std::uint32_t>(set))); }
  Rigid3 pose(int set) const {
    return sim_->map.camera(cam(0)).frame_at(SetId(static_cast<std::uint32_t>(set)))->cam_from_world;
  }

  const test::SimWorld world_{{}};
  const Similarity3 drift_of_a_round_{1.05, so3_exp({0, 0.03, 0}), {0.2, 0, -0.1}};
  std::optional<test::SimMap> sim_;
  Similarity3 drift_;
  KeyImageDatabase places_{RecogniseConfig{}};
  std::vector<LoopConstraint> loops_;
  bool thirds_ = false;  // images of the second visit show but a third each
  int next_third_ = 0, first_points_ = 0;
};

TEST_F(OfflineLoopsTest, TwoImagesOfALaterVisitCloseTheLoop) {
  fly(world_, drift_of_a_round_, {0, 5, kRound + 2, kRound + 8});
  ASSERT_GT((pose(kRound + 8).center() - truth(kRound + 8).center()).norm(), 0.2);
  const std::size_t before = sim_->map.points().size();
  const OfflineLoopsReport report = look();
  EXPECT_EQ(report.closed, 1);
  EXPECT_EQ(loops_.size(), 1U);
  for (const int set : {0, kRound + 2, kRound + 8}) {
    EXPECT_THAT(pose(set), PoseNear(truth(set), 0.006, 0.03)) << set;
  }
  EXPECT_LT(sim_->map.points().size(), before - 20) << "the points of both visits are one";
}

TEST_F(OfflineLoopsTest, OneImageIsNotEnough) {
  fly(world_, drift_of_a_round_, {0, 5, kRound + 2});
  EXPECT_FALSE(look().changed());
}

TEST_F(OfflineLoopsTest, NeitherAreTwoOfFewPoints) {
  thirds_ = true;
  fly(world_, drift_of_a_round_, {0, 5, kRound + 2, kRound + 8});
  EXPECT_FALSE(look(3 * first_points_ / 10).changed());
}

TEST_F(OfflineLoopsTest, ThreeOfFewPointsCloseItTogether) {
  thirds_ = true;
  fly(world_, drift_of_a_round_, {0, 5, kRound + 2, kRound + 5, kRound + 8});
  const auto before = static_cast<int>(sim_->map.points().size());
  EXPECT_EQ(look(3 * first_points_ / 10).closed, 1);
  for (const int set : {0, kRound + 2, kRound + 5, kRound + 8}) {
    EXPECT_THAT(pose(set), PoseNear(truth(set), 0.006, 0.03)) << set;
  }
  EXPECT_LT(static_cast<int>(sim_->map.points().size()), before - first_points_ / 2) << "what each of them shows";
}

TEST_F(OfflineLoopsTest, WhatIsFlatMayHangElsewhereToo) {
  fly(test::SimWorld({.layout = test::Layout::kPlane}), drift_of_a_round_, {0, 5, kRound + 2, kRound + 8});
  EXPECT_FALSE(look().changed());
}

TEST_F(OfflineLoopsTest, WhereTheMapDidNotDriftPointsBecomeOne) {
  fly(world_, Similarity3{}, {0, 5, kRound + 2});
  const std::size_t before = sim_->map.points().size();
  const OfflineLoopsReport report = look();
  EXPECT_EQ(report.closed, 0);
  EXPECT_EQ(report.linked, 1);
  EXPECT_LT(sim_->map.points().size(), before - 20);
  for (const int set : {0, kRound + 2}) EXPECT_THAT(pose(set), PoseNear(truth(set), 1e-9, 1e-9));
  EXPECT_FALSE(look().changed()) << "once";
}

TEST_F(OfflineLoopsTest, ImagesOfOneVisitTellNothingNew) {
  fly(world_, drift_of_a_round_, {kRound, kRound + 2, kRound + 8});
  EXPECT_FALSE(look().changed());
}

}  // namespace
}  // namespace coslam::offline_loops_test
