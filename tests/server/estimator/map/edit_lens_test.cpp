// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/support/matchers.h"
#include "tests/support/same_fields.h"
#include "tests/support/sim_map.h"

namespace coslam::edit_lens_test {
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

TEST_F(EditLensTest, ZoomsAreTakenOutOfWhatWasSeenMeanwhile) {
  sim_.edit.correct_lens(camera(0), lens_, LensCorrection::Values::Zero());
  const Eigen::Vector2d centre = Eigen::Vector2d(camera(0).model.cx, camera(0).model.cy) + camera(0).lens.centre_px();
  const SetId first = camera(0).frames.front().set, last = camera(0).frames.back().set;
  std::vector<std::pair<SetId, Eigen::Vector2d>> before;
  for (const FramePose& f : camera(0).frames) {
    for (const HeldTrack& h : f.held) before.emplace_back(f.set, camera(0).raw_px(h.undistorted_px.cast<double>()));
  }
  const auto keys_before = seen_raw_px(0), of_other = seen_raw_px(1);
  sim_.edit.leave_zoom_out(camera(0), std::vector<FrameZoom>{{first, 0.01}, {last, 0.03}});
  std::size_t at = 0;
  for (const FramePose& f : camera(0).frames) {
    const double share = static_cast<double>(f.set.value - first.value) / (last.value - first.value);
    for (const HeldTrack& h : f.held) {
      const Eigen::Vector2d expected = centre + std::exp(-(0.01 + 0.02 * share)) * (before[at++].second - centre);
      ASSERT_THAT(camera(0).raw_px(h.undistorted_px.cast<double>()), VectorNear(expected, 0.01));
    }
  }
  ASSERT_GT(at, 100U);
  const auto keys_after = seen_raw_px(0);
  for (std::size_t i = 0; i < keys_after.size(); ++i) {
    ASSERT_LE((keys_after[i] - centre).norm(), 0.992 * (keys_before[i] - centre).norm() + 0.05);
  }
  EXPECT_EQ(seen_raw_px(1), of_other);
  EXPECT_EQ(camera(0).breathing, 0);
  sim_.edit.note_breathing(camera(0), 0.03);
  sim_.edit.note_breathing(camera(0), 0.02);
  EXPECT_EQ(camera(0).breathing, 0.03);
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

// An image of half the size, say.
TEST_F(EditLensTest, WhatWasSeenThroughAnotherCalibrationStaysInItsDirection) {
  const auto directions = [&] {
    std::vector<Eigen::Vector2d> n;
    for (const auto& [id, p] : sim_.map.points()) {
      for (const KeyObservation& o : p.key_observations) {
        if (o.camera == camera(0).id)
          n.push_back(camera(0).model.normalized_from_pixel(o.undistorted_px.cast<double>()));
      }
    }
    return n;
  };
  const std::vector<Eigen::Vector2d> before = directions();
  CameraModel half = camera(0).model;
  for (double* v : {&half.fx, &half.fy, &half.cx, &half.cy}) *v /= 2;
  half.width_px /= 2;
  half.height_px /= 2;
  sim_.edit.restart_camera(camera(0).id, RunId(79), half);
  const std::vector<Eigen::Vector2d> after = directions();
  ASSERT_GT(before.size(), 20U);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_LT((after[i] - before[i]).norm(), 1e-6) << i;
}

TEST_F(EditLensTest, OutlivesTheServer) {
  sim_.edit.correct_lens(camera(0), lens_, LensCorrection::Values::Constant(0.5));
  sim_.edit.note_breathing(camera(0), 0.03);
  const std::vector<FrameZoom> zooms{{SetId(0), 0.1}};
  sim_.edit.leave_zoom_out(camera(0), zooms);
  sim_.edit.mark_co_moving(camera(0).tracks.begin()->second, SetId(0));
  Tables tables;
  MapRows rows;
  for (Row& row : rows.changes(sim_.map)) tables[row.table][row.key] = std::move(row.bytes);
  MapEdit restored{MapConfig()};
  restored.restore(tables);
  EXPECT_EQ(test::Difference(test::Compared::kKept).of(restored.map(), sim_.map), "");
  EXPECT_EQ(restored.map().cameras()[0].lens, camera(0).lens);
  EXPECT_EQ(restored.map().cameras()[0].lens_sigma[0], 0.5);
  EXPECT_EQ(restored.map().cameras()[0].breathing, 0.03);
  EXPECT_NE(restored.map().cameras()[0].frames.front().zoom_taken_out, 0);
  EXPECT_EQ(restored.map().cameras()[0].tracks.begin()->second.co_moving_since, SetId(0));
  EXPECT_TRUE(restored.map().cameras()[1].lens.none());
  const std::size_t all = sim_.map.points().size();
  EXPECT_LT(rows.changes(sim_.map).size(), all);
  sim_.edit.correct_lens(camera(0), {}, LensCorrection::Values::Zero());
  const auto seen_by_it = std::ranges::count_if(sim_.map.points(), [&](const auto& entry) {
    return std::ranges::any_of(entry.second.key_observations,
                               [&](const KeyObservation& o) { return o.camera == camera(0).id; });
  });
  EXPECT_GE(rows.changes(sim_.map).size(), static_cast<std::size_t>(seen_by_it))
      << "they lie where the other lens has them";
}

}  // namespace
}  // namespace coslam::edit_lens_test
