// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/place_recognition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "tests/server/estimator/places/place_stages.h"
#include "tests/support/map_fit.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::place_recognition_test {
namespace {

using test::cam;
using test::Fit;
using test::fit_of;
using test::PoseNear;

constexpr auto kUnconfirmed = static_cast<std::size_t>(PlaceDoubt::kUnconfirmed);

class MeetTest : public testing::Test {
 protected:
  explicit MeetTest(int cameras = 3) : sim_(world_, test::paths_side_by_side(cameras)) {}
  const MapCamera& camera(int i) const { return sim_.map.camera(cam(i)); }
  test::PlaceStagesReport step() { return stages_.run(sim_.edit, sim_.set, view_graph(sim_.map, sim_.set)); }

  PlaceRecognitionConfig config_;
  const AskConfig ask_;
  test::PlaceStages stages_{config_};
  const test::SimWorld world_{{}};
  test::SimMap sim_;
};

TEST_F(MeetTest, ACameraWithoutAMapIsAskedWhatItSees) {
  int asked = 0;
  for (int i = 0; i < 80; ++i) {
    sim_.ingest();
    asked += step().requests.contains(cam(1));
  }
  const auto period = static_cast<int>(sim_.map.sets_in(ask_.least_period_s));
  EXPECT_EQ(asked, (80 + period - 1) / period) << "no answer comes";
}

TEST_F(MeetTest, APlacedOneIsAskedWhenItsViewChanges) {
  test::SimMap still(world_, {test::still_path(test::looking({0, 0, 0}))});
  test::SimMap turning(world_, {[](double t_s) { return test::looking({0, 0, 0}, 0.5 * t_s); }});
  int asked_still = 0, asked_turning = 0;
  for (auto [sim, asked] : {std::pair(&still, &asked_still), std::pair(&turning, &asked_turning)}) {
    test::PlaceStages stages(config_);
    bool wanted = true;
    for (int i = 0; i < 90; ++i) {
      sim->ingest(false, wanted);
      sim->place_truly();
      sim->add_points();
      wanted = !stages.run(sim->edit, sim->set, ViewGraph()).requests.empty();
      *asked += wanted;
    }
  }
  EXPECT_EQ(asked_still, 0);
  EXPECT_GE(asked_turning, 3);
  EXPECT_LE(asked_turning, 5) << "1.5 rad in 3 s";
}

TEST_F(MeetTest, ALateCameraIsPlaced) {
  // Two are in a map as truth has it.
  for (int i = 0; i < 10; ++i) {
    sim_.ingest(false, i == 0 || i == 9);
    sim_.place_truly(cam(0));
    sim_.place_truly(cam(1));
    if (i == 0) {
      for (int p = 0; p < world_.size(); ++p) {
        if (sim_.track_of(cam(0), p) != nullptr || sim_.track_of(cam(1), p) != nullptr) sim_.add_point(p);
      }
    }
    if (i < 9) step();
  }
  const test::PlaceStagesReport report = step();
  EXPECT_EQ(report.placed, 1);
  EXPECT_EQ(camera(2).map, sim_.id);
  EXPECT_THAT(camera(2).frames.back().cam_from_world, PoseNear(sim_.truth(cam(2), sim_.set.id), 0.006, 0.03));
  int bound = 0;
  for (const auto& [id, t] : camera(2).tracks) {
    if (t.point == PointId()) continue;
    ++bound;
    EXPECT_EQ(sim_.world_point(*sim_.map.find(t.point)), sim_.world_point(cam(2), id));
  }
  EXPECT_GE(bound, config_.recognise.min_inliers);
}

// Three without a map come at once. What the first of them moves, the next see moved, however many look at a time.
TEST_F(MeetTest, TheMapIsTheSameHoweverManyLookAtATime) {
  struct AtATime : Workers {
    explicit AtATime(std::size_t n) : many(n) {}
    std::size_t at_once() const override { return many; }
    std::size_t many;
  };
  struct Outcome {
    std::vector<Rigid3> poses;
    std::vector<std::pair<PointId, Eigen::Vector3d>> points;
    int placed = 0;
  };
  const auto outcome = [&](Workers& workers) {
    test::SimMap sim(world_, test::paths_side_by_side(4));
    test::PlaceStages stages(config_);
    Outcome out;
    for (int i = 0; i < 10; ++i) {
      sim.ingest(false, i == 0 || i == 9);
      sim.place_truly(cam(0));
      if (i == 0) sim.add_points(0.03);
      out.placed += stages.run(sim.edit, sim.set, view_graph(sim.map, sim.set), workers).placed;
    }
    for (const MapCamera& c : sim.map.cameras()) out.poses.push_back(c.frames.back().cam_from_world);
    for (const auto& [id, p] : sim.map.points()) out.points.emplace_back(id, p.position);
    return out;
  };
  AtATime one(1), all(8);
  const Outcome alone = outcome(one), together = outcome(all);
  EXPECT_EQ(alone.placed, 3);
  EXPECT_EQ(together.placed, 3);
  EXPECT_EQ(alone.points, together.points);
  for (std::size_t c = 0; c < alone.poses.size(); ++c) {
    EXPECT_EQ(alone.poses[c].translation, together.poses[c].translation) << c;
    EXPECT_EQ(alone.poses[c].rotation.coeffs(), together.poses[c].rotation.coeffs()) << c;
  }
}

TEST_F(MeetTest, ImagesOfARestlessCameraAreAskedForWithinTheBudget) {
  constexpr int kSeconds = 20;
  test::SimMap whirling(world_, {[](double t_s) { return test::looking({0, 0, 4}, 2 * t_s); }});
  int asked = 0;
  for (int i = 0; i < kSeconds * 30; ++i) {
    whirling.ingest(false, asked > 0);
    whirling.place_truly();
    whirling.add_points();
    asked += !stages_.run(whirling.edit, whirling.set, ViewGraph()).requests.empty();
  }
  EXPECT_LE(asked, ask_.image_burst + kSeconds * ask_.images_per_s + 1);
  EXPECT_GE(asked, kSeconds * ask_.images_per_s);
}

// All that is seen lies in one plane: it may be a poster that hangs elsewhere too.
TEST_F(MeetTest, APlaneAlonePlacesOnlyWhoWasLostThere) {
  const test::SimWorld wall({.layout = test::Layout::kPlane});
  for (const bool was_there : {false, true}) {
    test::SimMap sim(wall, test::paths_side_by_side(2));
    test::PlaceStages stages(config_);
    for (int i = 0; i < 10; ++i) {
      sim.ingest(false, i == 0);
      sim.place_truly(cam(0));
      if (was_there) sim.place_truly(cam(1));
      if (i == 0) sim.add_points();
      stages.run(sim.edit, sim.set, view_graph(sim.map, sim.set));
    }
    if (was_there) sim.edit.leave_map(sim.map.camera(cam(1)));
    sim.ingest(false, true);
    sim.place_truly(cam(0));
    const test::PlaceStagesReport report = stages.run(sim.edit, sim.set, view_graph(sim.map, sim.set));
    EXPECT_GE(report.sightings, 1);
    EXPECT_EQ(report.placed, was_there ? 1 : 0);
    EXPECT_EQ(report.doubts.at(static_cast<std::size_t>(PlaceDoubt::kFlat)), was_there ? 0 : 1);
    EXPECT_EQ(sim.map.camera(cam(1)).map, was_there ? sim.id : MapId());
  }
}

TEST_F(MeetTest, ACameraThatSeesSomethingElseIsNotPlaced) {
  const test::SimWorld other({.seed = 77});
  test::SimMap sim(world_, test::paths_side_by_side(2));
  test::SimTracker stranger(other, test::paths_side_by_side(1)[0], {}, "stranger", RunId(9));
  sim.ingest(false, true);
  sim.place_truly();
  sim.add_points();
  stages_.run(sim.edit, sim.set, ViewGraph());
  sim.edit.add_camera("stranger", RunId(9), test::sim_camera());
  FrameSet set{SetId(1), test::kPeriodNs, {{cam(2), stranger.observe(FrameId(0), test::kPeriodNs), {}, {}}}};
  set.frames[0].descriptors = stranger.describe(set.frames[0].frame);
  sim.edit.ingest(set);
  EXPECT_EQ(stages_.run(sim.edit, set, ViewGraph()).placed, 0);
  EXPECT_EQ(sim.map.camera(cam(2)).map, MapId());
}

// Cameras 0 and 1 in one map, as truth has it; camera 2 in a map of its own, elsewhere and 2.5 times as large.
class MergeTest : public MeetTest {
 protected:
  MergeTest() {
    for (int i = 0; i < 40; ++i) {
      sim_.ingest(false, i == 0);
      for (int c = 0; c < 2; ++c) sim_.place_truly(cam(c));
      sim_.place(cam(2), own_, transform_world(sim_.truth(cam(2), sim_.set.id), own_from_world_));
      if (i > 0) continue;
      for (int p = 0; p < world_.size(); ++p) {
        if (sim_.track_of(cam(0), p) != nullptr || sim_.track_of(cam(1), p) != nullptr) sim_.add_point(p);
        const ServerTrack* t = sim_.track_of(cam(2), p);
        if (t != nullptr) sim_.bind(sim_.create(own_, own_from_world_ * world_.position(p)), cam(2), *t);
      }
      sim_.edit.add_key_frame(sim_.set.id);
      step();
    }
  }
  // The same, with descriptors, and the stage called.
  test::PlaceStagesReport see() {
    sim_.ingest(false, true);
    for (int c = 0; c < 2; ++c) sim_.place_truly(cam(c));
    sim_.place(cam(2), own_, transform_world(sim_.truth(cam(2), sim_.set.id), own_from_world_));
    return step();
  }
  int meet() {
    EXPECT_EQ(see().merged, 0) << "it has to be confirmed";
    return see().merged;
  }
  const MapId own_ = sim_.edit.new_map(Why::kStartedAlone, 1);
  const Similarity3 own_from_world_{2.5, so3_exp({0.1, 0.8, -0.2}), {5, -2, 1}};
};

TEST_F(MergeTest, TwoMapsBecomeOneWithOneScale) {
  const MapEpoch before = sim_.map.epoch();
  EXPECT_EQ(meet(), 1);
  EXPECT_GT(sim_.map.epoch(), before);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(camera(i).map, sim_.id) << "the one with more frames keeps its coordinates";
  const Fit fit = fit_of(sim_, sim_.id);
  EXPECT_EQ(fit.poses, 3 * 42);
  EXPECT_NEAR(fit.map_from_world.scale, 1, 0.02);
  EXPECT_LT(fit.worst_pose_m, 0.08);
  EXPECT_LT(fit.worst_pose_rad, 0.01);
  EXPECT_LT(fit.median_point_m, 0.05);
  // The agent of camera 2 is told how its world moved: the inverse of how it was set off.
  EXPECT_NEAR(camera(2).moved.scale, 1 / 2.5, 0.02);
  EXPECT_NEAR(camera(0).moved.scale, 1, 1e-9);
}

TEST_F(MergeTest, WhatIsNotConfirmedSoonIsForgotten) {
  EXPECT_GE(see().doubts.at(kUnconfirmed), 1);
  for (int i = 0; i < 151; ++i) {  // five seconds
    sim_.ingest();
    for (int c = 0; c < 2; ++c) sim_.place_truly(cam(c));
    sim_.place(cam(2), own_, transform_world(sim_.truth(cam(2), sim_.set.id), own_from_world_));
    step();
  }
  EXPECT_EQ(meet(), 1) << "it takes two images again";
}

TEST_F(MergeTest, AMapThatNobodyIsInAnyMoreIsStillLookedFor) {
  see();
  for (int c = 0; c < 2; ++c) sim_.edit.set_alive(cam(c), false);
  int asked = 0;
  for (int i = 0; i < 60; ++i) {  // two seconds, in which the view does not change
    sim_.look();
    sim_.set.frames.erase(sim_.set.frames.begin(), sim_.set.frames.begin() + 2);
    sim_.take();
    sim_.place(cam(2), own_, camera(2).frames.end()[-2].cam_from_world);
    const test::PlaceStagesReport report = step();
    const auto request = report.requests.find(cam(2));
    asked += request != report.requests.end() && request->second == DescriptorRequest::kEverywhere;
  }
  EXPECT_GE(asked, 1);
}

TEST_F(MergeTest, MapsThatShowOnePlaceBecomeOneAtTheEnd) {
  EXPECT_EQ(see().merged, 0);
  const std::vector<JoinedMaps> joined = stages_.recognition.join_all(sim_.edit);
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_GE(joined[0].images, 2);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(camera(i).map, sim_.id);
  const Fit fit = fit_of(sim_, sim_.id);
  EXPECT_NEAR(fit.map_from_world.scale, 1, 0.02);
  EXPECT_LT(fit.worst_pose_m, 0.08);
  EXPECT_TRUE(stages_.recognition.join_all(sim_.edit).empty());
}

TEST_F(MergeTest, PointsThatAreTheSameAreFused) {
  const std::size_t before = sim_.map.points().size();
  meet();
  EXPECT_LT(sim_.map.points().size(), before - 20);
  int shared = 0;
  for (const auto& [id, p] : sim_.map.points()) {
    EXPECT_EQ(p.map, sim_.id);
    int of_two = 0;
    for (const BoundTrack& b : p.bound) {
      EXPECT_EQ(sim_.map.camera(b.camera).tracks.at(b.track).point, id);
      EXPECT_EQ(sim_.world_point(b.camera, b.track), sim_.world_point(p));
      of_two += b.camera == cam(2);
    }
    shared += of_two > 0 && p.bound.size() > 1;
  }
  EXPECT_GT(shared, 25);
}

TEST_F(MergeTest, ASecondTimeThereIsNothingToMerge) {
  EXPECT_EQ(meet(), 1);
  sim_.ingest(false, true);
  sim_.place_truly();
  EXPECT_EQ(step().merged, 0);
}

// One camera turns once around in the middle of the room; what it measures drifts by a similarity that grows. Then it
// sees again what it saw first.
class LoopTest : public testing::Test {
 protected:
  static constexpr int kSets = 420;
  static Rigid3 path(double t_s) {
    const double a = 2 * std::numbers::pi * t_s / 12;
    return test::looking({0.8 * std::sin(a), 0.2 * std::sin(2 * a), 5 - 0.8 * std::cos(a)}, a);
  }
  static Similarity3 drift(int set) {
    const double s = set / static_cast<double>(kSets);
    return {1 + 0.06 * s, so3_exp({0.01 * s, 0.04 * s, -0.02 * s}), {0.2 * s, -0.1 * s, 0.15 * s}};
  }
  void step(bool descriptors) {
    sim_.ingest(false, descriptors);
    const int now = static_cast<int>(sim_.set.id.value);
    sim_.place(cam(0), transform_world(sim_.truth(cam(0), sim_.set.id), drift(now)));
    for (const auto& [id, t] : sim_.map.camera(cam(0)).tracks) {
      if (t.bound()) continue;
      sim_.bind(sim_.create(drift(now) * world_.position(sim_.world_point(cam(0), id))), cam(0), t);
    }
    if (now % 10 == 0) sim_.edit.add_key_frame(sim_.set.id);
    report_ = stages_.run(sim_.edit, sim_.set, view_graph(sim_.map, sim_.set));
  }
  void go_around() {
    bool wanted = true;
    for (int i = 0; i < kSets && closed_ == 0; ++i) {
      step(wanted);
      wanted = !report_.requests.empty();
      closed_ += report_.closed;
      linked_ += report_.linked;
    }
  }

  PlaceRecognitionConfig config_;
  const test::SimWorld world_{{}};
  test::SimMap sim_{world_, {path}};
  test::PlaceStages stages_{config_};
  test::PlaceStagesReport report_;
  int closed_ = 0, linked_ = 0;
};

TEST_F(LoopTest, AnOldPlaceDrawsTheMapTogether) {
  go_around();
  ASSERT_EQ(closed_, 1);
  EXPECT_EQ(report_.to_adjust, sim_.id);
  const Rigid3 first = sim_.map.camera(cam(0)).frames.front().cam_from_world;
  EXPECT_THAT(first, PoseNear(sim_.truth(cam(0), SetId(0)), 1e-9, 1e-9)) << "where the map began stays";
  const Rigid3 now = sim_.map.camera(cam(0)).frames.back().cam_from_world;
  const Rigid3 truth = sim_.truth(cam(0), sim_.set.id);
  const int sets = static_cast<int>(sim_.set.id.value);
  const double before = (transform_world(truth, drift(sets)).center() - truth.center()).norm();
  EXPECT_LT((now.center() - truth.center()).norm(), 0.2 * before);
  const Fit fit = fit_of(sim_, sim_.id);
  EXPECT_LT(fit.worst_pose_m, 0.5 * before);
  // The agent is told how its world moved.
  const Similarity3& moved = sim_.map.camera(cam(0)).moved;
  EXPECT_NEAR(moved.scale, 1 / drift(sets).scale, 0.02);
  // Points of the first view are seen again under their old ids.
  int again = 0;
  for (const auto& [id, t] : sim_.map.camera(cam(0)).tracks) {
    const MapPoint* p = sim_.map.find(t.point);
    again += p != nullptr && p->created.value < 100;
  }
  EXPECT_GT(again, config_.decide.min_merge_inliers / 2);
}

TEST_F(LoopTest, NotWhenToldNotTo) {
  config_.loops = false;
  stages_ = test::PlaceStages(config_);
  go_around();
  EXPECT_EQ(closed_ + linked_, 0);
}

// Two cameras side by side in one map, each with points of its own. What belongs to the second one is set off a little,
// and few features are common to both.
class DriftTest : public MeetTest {
 protected:
  DriftTest() : MeetTest(2) {}
  static constexpr int kCommon = 14;

  // The world points that both see, the first few of them alone described.
  void thin_descriptors() {
    std::vector<int> common;
    for (int p = 0; p < world_.size(); ++p) {
      if (sim_.all_follow(p)) common.push_back(p);
    }
    ASSERT_GT(common.size(), 40U);
    for (CameraFrame& cf : sim_.set.frames) {
      DescriptorReply kept = *cf.descriptors;
      kept.tracks.clear();
      kept.descriptors.clear();
      for (std::size_t i = 0; i < cf.descriptors->tracks.size(); ++i) {
        const int p = sim_.world_point(cf.camera, cf.descriptors->tracks[i]);
        const auto at = std::ranges::find(common, p);
        if (at != common.end() && (at - common.begin()) % 3 != 0) continue;
        if (at != common.end() && (at - common.begin()) / 3 >= kCommon) continue;
        kept.tracks.push_back(cf.descriptors->tracks[i]);
        const auto begin = cf.descriptors->descriptors.begin() + static_cast<std::ptrdiff_t>(i * kDescriptorBytes);
        kept.descriptors.insert(kept.descriptors.end(), begin, begin + kDescriptorBytes);
      }
      cf.descriptors = kept;
    }
  }
  // scatter_m: of every single point of the second camera.
  void run(int sets, double scatter_m = 0) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> noise(0, scatter_m + 1e-12);
    for (int i = 0; i < sets && totals_.closed == 0; ++i) {
      sim_.ingest(false, true);
      sim_.place_truly(cam(0));
      sim_.place(cam(1), transform_world(sim_.truth(cam(1), sim_.set.id), off_));
      for (int c = 0; c < 2; ++c) {
        for (const auto& [id, t] : sim_.map.camera(cam(c)).tracks) {
          if (t.bound()) continue;
          Eigen::Vector3d at = world_.position(sim_.world_point(cam(c), id));
          if (c == 1) at = off_ * at + Eigen::Vector3d(noise(random), noise(random), noise(random));
          sim_.bind(sim_.create(at), cam(c), t);
        }
      }
      sim_.edit.add_key_frame(sim_.set.id);
      thin_descriptors();
      const test::PlaceStagesReport r = step();
      totals_.closed += r.closed;
      totals_.expected += r.expected;
      totals_.doubts.at(kUnconfirmed) += r.doubts.at(kUnconfirmed);
    }
  }
  // Of where one camera is as the other sees it.
  double error_m() const {
    const auto between = [](const Rigid3& a, const Rigid3& b) { return (a * b.inverse()).translation; };
    const SetId now = sim_.set.id;
    return (between(camera(0).frames.back().cam_from_world, camera(1).frames.back().cam_from_world) -
            between(sim_.truth(cam(0), now), sim_.truth(cam(1), now)))
        .norm();
  }
  int shared() {
    int n = 0;
    for (const auto& [id, p] : sim_.map.points()) n += p.bound.size() > 1;
    return n;
  }
  Similarity3 off_;
  test::PlaceStagesReport totals_;
};

TEST_F(DriftTest, PointsWhereTheyAreExpectedBecomeOne) {
  run(10);
  EXPECT_EQ(totals_.closed, 0);
  EXPECT_GT(totals_.expected, 0);
  EXPECT_GT(shared(), kCommon / 2);
}

TEST_F(DriftTest, FewPointsThatAreAllBesideDrawTheMapTogether) {
  off_.translation = {0.06, -0.03, 0.04};
  run(10);
  ASSERT_EQ(totals_.closed, 1);
  EXPECT_LT(kCommon, config_.decide.min_merge_inliers);
  EXPECT_GE(totals_.doubts.at(kUnconfirmed), 1) << "it has to be confirmed";
  EXPECT_LT(error_m(), 0.25 * off_.translation.norm());
  EXPECT_GT(shared(), kCommon / 2);
}

TEST_F(DriftTest, PointsThatDoNotAgreeMoveNothing) {
  run(10, 0.08);
  EXPECT_EQ(totals_.closed, 0);
  EXPECT_LT(error_m(), 1e-9);
}

}  // namespace
}  // namespace coslam::place_recognition_test
