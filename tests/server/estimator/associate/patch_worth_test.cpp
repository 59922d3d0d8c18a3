// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/patch_worth.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/support/sim_map.h"

namespace coslam::patch_worth_test {
namespace {

CameraId cam(int number) { return CameraId(static_cast<std::uint16_t>(number)); }

// Two cameras side by side; the first has points for what it sees of even number. No track has a patch but where a test
// says so.
class PatchWorthTest : public testing::Test {
 protected:
  PatchWorthTest() : sim_(world_, test::paths_side_by_side(2)) {
    sim_.advance(6);
    for (int p = 0; p < world_.size(); p += 2) {
      const ServerTrack* t = sim_.track_of(cam(0), p);
      if (t != nullptr) sim_.bind(sim_.create(world_.position(p)), cam(0), *t);
    }
  }
  // The next set, in which one camera sends a patch of that point of the world alone.
  void step(CameraId camera, int world_point) {
    FrameSet& set = sim_.look();
    for (CameraFrame& cf : set.frames) {
      const ServerTrack* t = sim_.track_of(camera, world_point);
      if (cf.camera == camera && t != nullptr) cf.patches = sim_.trackers[camera.value].cut(cf.frame, {t->id});
    }
    sim_.take();
    sim_.place_truly();
    for (const CameraFrame& cf : set.frames) {
      const ServerTrack* t = sim_.track_of(cf.camera, world_point);
      const MapPoint* p = t == nullptr ? nullptr : sim_.map.find(t->point);
      if (p != nullptr && t->patch_set == set.id) sim_.edit.give_patch(*p, cf.camera, *t);
    }
  }
  PatchWorth worth(CameraId camera, int world_point) {
    return PatchWorths(sim_.map, sim_.set).rank_of(camera, sim_.track_of(camera, world_point)->id).first;
  }
  // A mapped point of the world that both cameras see.
  int seen_by_both() {
    int p = 0;
    while (sim_.track_of(cam(0), p) == nullptr || sim_.track_of(cam(1), p) == nullptr) p += 2;
    return p;
  }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
};

TEST_F(PatchWorthTest, WhereNeitherHasOneBothHelp) {
  const int p = seen_by_both();
  EXPECT_EQ(worth(cam(0), p), PatchWorth::kHelps);
  EXPECT_EQ(worth(cam(1), p), PatchWorth::kHelps);
}

TEST_F(PatchWorthTest, WhereThePointHasOneThatOfTheTrackDecides) {
  const int p = seen_by_both();
  step(cam(0), p);
  EXPECT_EQ(worth(cam(1), p), PatchWorth::kDecides);
  EXPECT_EQ(worth(cam(0), p), PatchWorth::kAlone) << "it is there";
}

TEST_F(PatchWorthTest, WhereTheTrackHasOneThatOfThePointDecides) {
  const int p = seen_by_both();
  step(cam(1), p);
  EXPECT_EQ(worth(cam(0), p), PatchWorth::kDecides);
  EXPECT_EQ(worth(cam(1), p), PatchWorth::kAlone);
}

TEST_F(PatchWorthTest, WhatIsOnePointAlreadyNeedsNone) {
  const int p = seen_by_both();
  const ServerTrack& other = *sim_.track_of(cam(1), p);
  sim_.bind(*sim_.map.find(sim_.track_of(cam(0), p)->point), cam(1), other);
  EXPECT_EQ(worth(cam(1), p), PatchWorth::kAlone);
}

// Of the second camera's tracks nearly all that the first has a point for are named, and few of the others, which lie
// beside such by chance.
TEST_F(PatchWorthTest, TellsWhatBothSeeFromWhatIsNew) {
  const PatchWorths worths(sim_.map, sim_.set);
  std::array<int, 2> tracks{}, named{};  // of even and of odd number
  for (int p = 0; p < world_.size(); ++p) {
    const ServerTrack* t = sim_.track_of(cam(1), p);
    if (t == nullptr || sim_.track_of(cam(0), p) == nullptr) continue;
    const auto odd = static_cast<std::size_t>(p % 2);
    ++tracks.at(odd);
    named.at(odd) += worths.rank_of(cam(1), t->id).first != PatchWorth::kAlone ? 1 : 0;
  }
  EXPECT_GT(tracks[0], 30);
  EXPECT_GT(tracks[1], 30);
  EXPECT_GE(named[0], 0.95 * tracks[0]);
  EXPECT_LE(named[1], 0.3 * tracks[1]);
}

}  // namespace
}  // namespace coslam::patch_worth_test
