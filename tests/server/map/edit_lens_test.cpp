// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam {
namespace {

using test::VectorNear;

class EditLensTest : public testing::Test {
 protected:
  EditLensTest() : sim_(world_, test::paths_side_by_side(2)) {
    for (int i = 0; i < 12; ++i) {
      sim_.advance();
      if (i % 4 != 0) continue;
      sim_.add_points(0.002);
      sim_.edit.add_key_frame(sim_.set.id);
    }
    lens_.values << 0.03, 3, -2, 0.002, 0.001, -0.001, 0.01, -0.004, 0, 0.001, 0, 0;
  }
  const MapCamera& camera(std::size_t i) const { return sim_.map.cameras()[i]; }
  // Where all that a camera observed was in the raw image.
  std::vector<Eigen::Vector2d> seen_raw_px(std::size_t i) const {
    const MapCamera& c = camera(i);
    std::vector<Eigen::Vector2d> out;
    const auto add = [&](const Eigen::Vector2f& px) { out.push_back(c.raw_px(px.cast<double>())); };
    for (const auto& [id, t] : c.tracks) {
      for (const TrackPoint& p : t.seen) add(p.undistorted_px);
    }
    for (const FramePose& f : c.frames) {
      for (const HeldTrack& h : f.held) add(h.undistorted_px);
    }
    for (const auto& [id, p] : sim_.map.points()) {
      for (const KeyObservation& o : p.key_observations) {
        if (o.camera == c.id) add(o.undistorted_px);
      }
    }
    return out;
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  LensCorrection lens_;
};

TEST_F(EditLensTest, WhatWasSeenStaysWhereItWasInTheRawImage) {
  const auto before = seen_raw_px(0), of_other = seen_raw_px(1);
  ASSERT_GT(before.size(), 500U);
  sim_.edit.correct_lens(camera(0), lens_, LensCorrection::Values::Constant(0.5));
  EXPECT_EQ(camera(0).lens.values.cast<float>().cast<double>(), camera(0).lens.values) << "as its agent is told";
  EXPECT_EQ(camera(0).lens_sigma[0], 0.5);
  const auto after = seen_raw_px(0);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) ASSERT_THAT(after[i], VectorNear(before[i], 1e-3));
  EXPECT_EQ(seen_raw_px(1), of_other);
  EXPECT_TRUE(camera(1).lens.none());
  sim_.edit.correct_lens(camera(0), {}, LensCorrection::Values::Zero());
  const auto back = seen_raw_px(0);
  for (std::size_t i = 0; i < back.size(); ++i) ASSERT_THAT(back[i], VectorNear(before[i], 1e-3));
}

TEST_F(EditLensTest, IsToldInTheJournal) {
  sim_.edit.correct_lens(camera(0), lens_, LensCorrection::Values::Zero());
  const auto& events = sim_.edit.journal().events();
  EXPECT_EQ(std::ranges::count(events, EventKind::kCameraLens, &Event::kind), 1);
}

TEST_F(EditLensTest, AnAgentThatComesBackWithAnotherCalibrationStartsWithThat) {
  sim_.edit.correct_lens(camera(0), lens_, LensCorrection::Values::Zero());
  sim_.edit.restart_camera(camera(0).id, RunId(77), camera(0).model);
  EXPECT_FALSE(camera(0).lens.none()) << "the same one";
  CameraModel other = camera(0).model;
  other.fx += 1;
  sim_.edit.restart_camera(camera(0).id, RunId(78), other);
  EXPECT_TRUE(camera(0).lens.none());
}

TEST_F(EditLensTest, OutlivesTheServer) {
  sim_.edit.correct_lens(camera(0), lens_, LensCorrection::Values::Zero());
  Tables tables;
  MapRows rows;
  for (Row& row : rows.changes(sim_.map)) tables[row.table][row.key] = std::move(row.bytes);
  MapEdit restored{MapConfig()};
  restored.restore(tables);
  EXPECT_EQ(restored.map().cameras()[0].lens, camera(0).lens);
  EXPECT_TRUE(restored.map().cameras()[1].lens.none());
  const std::size_t all = sim_.map.points().size();
  EXPECT_LT(rows.changes(sim_.map).size(), all);
  sim_.edit.correct_lens(camera(0), {}, LensCorrection::Values::Zero());
  EXPECT_GT(rows.changes(sim_.map).size(), all) << "all points are where the other lens has them";
}

}  // namespace
}  // namespace coslam
