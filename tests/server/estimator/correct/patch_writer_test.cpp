// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/correct/patch_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "common/wire/codec.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

namespace coslam::patch_writer_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

constexpr CameraId kCam(0);

// Round numbers to test against, whatever the defaults are.
constexpr CorrectConfig kConfig{.moved_px = 0.15,
                                .covariance_ratio = 1.5,
                                .patch_period_s = 1.0 / 30,
                                .patches_per_request = 10,
                                .patch_refresh_s = 40.0 / 30};

class PatchWriterTest : public testing::Test {
 protected:
  PatchWriterTest() : sim_(world_, test::paths_side_by_side(1)) { next(); }

  void next(bool patches = false) {
    sim_.ingest(patches);
    sim_.place_truly();
  }
  const MapCamera& camera() { return sim_.map.camera(kCam); }
  // As an agent that tracks and missed nothing; `change` makes it another.
  template <class Change>
  MapPatch write(Change change, DescriptorRequest wants_descriptors = DescriptorRequest::kNone,
                 const PatchWorths* worths = nullptr) {
    TrackFrame frame = sim_.set.frames[0].frame;
    frame.pose_state = PoseState::kTracked;
    change(frame);
    MapPatch patch = writer_.begin(sim_.edit, camera(), frame, wants_descriptors);
    writer_.fill(sim_.map, camera(), frame, worths, &patch);
    return patch;
  }
  MapPatch write() {
    return write([](TrackFrame&) {});
  }
  // A world point that is seen and has no map point.
  int unmapped() {
    for (int p = 0; p < world_.size(); ++p) {
      const ServerTrack* t = sim_.track_of(kCam, p);
      if (t != nullptr && t->point == PointId()) return p;
    }
    return -1;
  }
  // The same, and it is seen for so many sets.
  int in_view_for(std::uint32_t sets) {
    const auto seen = [&](int p, std::uint32_t at) {
      const Eigen::Vector3d in_cam = sim_.truth(kCam, SetId(at)) * world_.position(p);
      return in_cam.z() > 1 && camera().model.contains_raw(camera().model.project(in_cam), 10);
    };
    for (int p = 0; p < world_.size(); ++p) {
      std::uint32_t i = 0;
      while (i < sets && seen(p, sim_.set.id.value + i)) ++i;
      const ServerTrack* t = sim_.track_of(kCam, p);
      if (i == sets && t != nullptr && !t->bound()) return p;
    }
    return -1;
  }
  TrackId track_of(const MapPoint& p) { return p.bound.front().track; }

  const test::SimWorld world_{{}};
  test::SimMap sim_;
  PatchWriter writer_{{RunId(9), ContinuedMap{RunId(8), MapEpoch(0)}}, kConfig};
};

TEST_F(PatchWriterTest, TheFirstPatchIsASnapshot) {
  const MapPoint& p = sim_.add_point(unmapped());
  const MapPatch patch = write();
  EXPECT_EQ(patch.agent, "cam0");
  EXPECT_EQ(patch.agent_run, sim_.trackers[0].run());
  EXPECT_EQ(patch.server_run, RunId(9));
  EXPECT_EQ(patch.sequence, 1U);
  EXPECT_TRUE(patch.snapshot);
  EXPECT_EQ(patch.after_frame, sim_.set.frames[0].frame.frame);
  ASSERT_EQ(patch.updated.size(), 1U);
  EXPECT_EQ(patch.updated[0].track, track_of(p));
  EXPECT_EQ(patch.updated[0].point, p.id);
  EXPECT_EQ(patch.updated[0].position, p.position.cast<float>());
  EXPECT_EQ(patch.updated[0].covariance, pack_covariance(p.covariance));
}

// A server that went on with a map tells so those that speak of the server before it.
TEST_F(PatchWriterTest, WhoseMapGoesOnIsToldToThoseWhoKnewIt) {
  next();
  const auto of_the_former = [](TrackFrame& f) { f.server_run = RunId(8); };
  const Similarity3 moved{1.5, Eigen::Quaterniond::Identity(), {1, 2, 3}};
  sim_.edit.carry_agent(camera(), moved);
  sim_.edit.raise_epoch();
  const MapPatch first = write(of_the_former);
  EXPECT_EQ(first.continues, (ContinuedMap{RunId(8), MapEpoch(0)}));
  EXPECT_EQ(first.new_from_old.scale, 1.5) << "it has moved since";
  EXPECT_EQ(first.epoch, MapEpoch(1));
  next();
  const MapPatch second = write(of_the_former);  // sent before the first came
  EXPECT_TRUE(second.continues);
  EXPECT_EQ(second.new_from_old.scale, 1.0);
  EXPECT_FALSE(write([](TrackFrame& f) { f.server_run = RunId(9); }).continues);
  EXPECT_FALSE(write([](TrackFrame& f) { f.server_run = RunId(7); }).continues) << "of yet another server";
}

TEST_F(PatchWriterTest, WhoHasLeftItsMapIsNotToldThatItGoesOn) {
  sim_.edit.leave_map(camera());
  sim_.ingest(false);
  EXPECT_FALSE(write([](TrackFrame& f) { f.server_run = RunId(8); }).continues);
}

TEST_F(PatchWriterTest, ThenOnlyWhatChanged) {
  sim_.add_point(unmapped());
  const MapPoint& removed = sim_.add_point(unmapped());
  const TrackId freed = track_of(removed);
  write();
  EXPECT_THAT(write().updated, IsEmpty());
  const MapPoint& added = sim_.add_point(unmapped());
  sim_.edit.remove_point(removed, Why::kTooFewViews);
  const MapPatch patch = write();
  EXPECT_EQ(patch.sequence, 3U);
  EXPECT_FALSE(patch.snapshot);
  ASSERT_EQ(patch.updated.size(), 1U);
  EXPECT_EQ(patch.updated[0].track, track_of(added));
  EXPECT_THAT(patch.unbound, ElementsAre(freed));
  EXPECT_THAT(write().unbound, IsEmpty());
}

TEST_F(PatchWriterTest, AMoveIsToldWhenItShowsInTheImage) {
  const MapPoint& p = sim_.add_point(unmapped());
  write();
  const double distance_m = (p.position - camera().frames.back().cam_from_world.center()).norm();
  const double pixel_m = distance_m / camera().model.focal_px();
  sim_.shift(p, {0.1 * pixel_m, 0, 0});
  EXPECT_THAT(write().updated, IsEmpty()) << "0.1 px";
  sim_.shift(p, {0.1 * pixel_m, 0, 0});
  EXPECT_EQ(write().updated.size(), 1U) << "0.2 px since it was told";
  EXPECT_THAT(write().updated, IsEmpty());
}

TEST_F(PatchWriterTest, CovarianceAndStateAreToldWhenTheyChange) {
  const MapPoint& p = sim_.add_point(unmapped());
  const auto spread = [&](double factor) { sim_.edit.move_point(p, p.position, factor * p.covariance); };
  write();
  spread(1.3);
  EXPECT_THAT(write().updated, IsEmpty());
  spread(1.3);
  EXPECT_EQ(write().updated.size(), 1U);
  spread(1 / 1.6);
  EXPECT_EQ(write().updated.size(), 1U);
  sim_.set_moving(p);
  const MapPatch patch = write();
  ASSERT_EQ(patch.updated.size(), 1U);
  EXPECT_EQ(patch.updated[0].state, PointState::kDynamic);
}

TEST_F(PatchWriterTest, ATrackThatChangesItsPointIsToldAsAnUpdate) {
  const MapPoint& a = sim_.add_point(unmapped());
  const MapPoint& b = sim_.create(a.position);
  write();
  sim_.edit.fuse(b.id, a.id, Why::kOneCorner);
  const MapPatch patch = write();
  ASSERT_EQ(patch.updated.size(), 1U);
  EXPECT_EQ(patch.updated[0].point, b.id);
  EXPECT_THAT(patch.unbound, IsEmpty());
}

TEST_F(PatchWriterTest, ASnapshotOnRequestAndForAnotherMap) {
  sim_.add_points();
  const std::size_t all = write().updated.size();
  EXPECT_GT(all, 50U);
  const MapPatch asked = write([](TrackFrame& f) { f.wants_snapshot = true; });
  EXPECT_TRUE(asked.snapshot);
  EXPECT_EQ(asked.sequence, 2U) << "the sequence goes on";
  EXPECT_EQ(asked.updated.size(), all);
  sim_.place(kCam, sim_.edit.new_map(Why::kStartedAlone, 1), sim_.truth(kCam, sim_.set.id));
  EXPECT_TRUE(write().snapshot);
  EXPECT_FALSE(write().snapshot);
}

// One datagram: the middleware repeats what is cut into several while it still waits in a link's queue.
TEST_F(PatchWriterTest, OnANarrowLinkAPatchIsOneDatagramAndTheRestComesLater) {
  constexpr std::size_t kSampleBytes = 1192, kHeadBytes = 210;  // the latter with a pose and a move
  const auto narrow = [](TrackFrame& f) { f.narrow_link = true; };
  sim_.add_points();
  std::set<TrackId> told;
  int patches = 0;
  for (MapPatch patch = write(narrow); !patch.updated.empty(); patch = write(narrow)) {
    const idl::MapPatch m = encode(patch);
    EXPECT_LE(kHeadBytes + m.updated().size() + m.unbound().size() + m.patch_requests().size(), kSampleBytes);
    EXPECT_TRUE(std::ranges::is_sorted(patch.updated, {}, &BoundPoint::track));
    for (const BoundPoint& b : patch.updated) EXPECT_TRUE(told.insert(b.track).second) << "told once";
    ++patches;
  }
  EXPECT_GT(patches, 2);
  EXPECT_EQ(told.size(), write([](TrackFrame& f) { f.wants_snapshot = true; }).updated.size());
}

TEST_F(PatchWriterTest, OnANarrowLinkWhatItMustNotRestOnIsToldFirstAndWhatMovedLast) {
  const auto told = [&] {
    std::vector<TrackId> tracks;
    for (const BoundPoint& b : write([](TrackFrame& f) { f.narrow_link = true; }).updated) tracks.push_back(b.track);
    return tracks;
  };
  std::vector<PointId> known;
  for (int i = 0; i < 20; ++i) known.push_back(sim_.add_point(unmapped()).id);
  write();
  for (const PointId p : known) sim_.shift(*sim_.map.find(p), {1, 0, 0});
  const TrackId wrong = track_of(*sim_.map.find(known[7])), moved = track_of(*sim_.map.find(known[8]));
  sim_.set_moving(*sim_.map.find(known[7]));
  sim_.add_points();
  const std::vector<TrackId> first = told();
  EXPECT_THAT(first, Contains(wrong));
  EXPECT_THAT(first, Not(Contains(moved))) << "new ones take the room";
  std::vector<TrackId> later;
  for (std::vector<TrackId> more = told(); !more.empty(); more = told())
    later.insert(later.end(), more.begin(), more.end());
  EXPECT_THAT(later, Contains(moved));
}

TEST_F(PatchWriterTest, AnotherAgentRunStartsFromNothing) {
  sim_.add_points();
  write();
  write();
  const MapPatch patch = write([](TrackFrame& f) { f.agent_run = RunId(77); });
  EXPECT_EQ(patch.agent_run, RunId(77));
  EXPECT_EQ(patch.sequence, 1U);
  EXPECT_TRUE(patch.snapshot);
}

TEST_F(PatchWriterTest, APoseIsGivenToThoseWhoDoNotKnow) {
  EXPECT_TRUE(write().placed) << "a snapshot";
  EXPECT_FALSE(write().placed);
  const MapPatch lost = write([](TrackFrame& f) { f.pose_state = PoseState::kLost; });
  ASSERT_TRUE(lost.placed);
  EXPECT_EQ(lost.placed->frame, sim_.set.frames[0].frame.frame);
  EXPECT_THAT(lost.placed->cam_from_world, test::PoseNear(sim_.truth(kCam, sim_.set.id), 1e-9, 1e-9));
  EXPECT_TRUE(write([](TrackFrame& f) { f.pose_state = PoseState::kNone; }).placed);
  sim_.ingest();  // a set without a pose
  EXPECT_FALSE(write([](TrackFrame& f) { f.pose_state = PoseState::kLost; }).placed);
}

TEST_F(PatchWriterTest, AMoveOfTheMapIsToldOnce) {
  sim_.add_points();
  write();
  const Similarity3 move{2.0, so3_exp({0, 1, 0}), {1, 2, 3}};
  sim_.edit.transform(sim_.id, move, Why::kScaleKnown);
  const MapPatch patch = write();
  EXPECT_EQ(patch.epoch, sim_.map.epoch());
  EXPECT_THAT(patch.new_from_old, test::SimilarityNear(move, 1e-7, 1e-9, 1e-12));
  EXPECT_THAT(patch.updated, IsEmpty()) << "the points moved with the map";
  const MapPatch next = write();
  EXPECT_THAT(next.new_from_old, test::SimilarityNear(Similarity3(), 1e-9, 1e-12, 1e-12));
  EXPECT_EQ(next.epoch, patch.epoch);
}

TEST_F(PatchWriterTest, ALensIsToldOnceAndWithEachSnapshot) {
  EXPECT_FALSE(write().lens.has_value());
  LensCorrection lens;
  lens.values[0] = 0.03;
  sim_.edit.correct_lens(camera(), lens, LensCorrection::Values::Zero());
  EXPECT_EQ(write().lens, camera().lens);
  EXPECT_FALSE(write().lens.has_value());
  sim_.set.frames[0].frame.wants_snapshot = true;
  EXPECT_EQ(write().lens, camera().lens);
}

TEST_F(PatchWriterTest, AsksForPatchesOfTracksThatLasted) {
  EXPECT_THAT(write().patch_requests, IsEmpty()) << "all tracks are new";
  for (int i = 0; i < 3; ++i) next();
  const MapPatch patch = write();
  EXPECT_EQ(patch.patch_requests.size(), 10U);
  EXPECT_TRUE(std::is_sorted(patch.patch_requests.begin(), patch.patch_requests.end()));
  for (const TrackId id : patch.patch_requests) EXPECT_EQ(camera().tracks.at(id).seen.size(), 4U);
}

TEST_F(PatchWriterTest, ThePatchOfAMappedTrackIsKeptAndOthersRefreshed) {
  for (int i = 0; i < 5; ++i) next(true);
  EXPECT_THAT(write().patch_requests, IsEmpty());
  const MapPoint& p = sim_.add_point(in_view_for(100));
  const TrackId mapped = track_of(p);
  for (int i = 0; i < 60; ++i) next();
  std::vector<TrackId> asked;
  for (int i = 0; i < 30; ++i) {
    const std::vector<TrackId> wanted = write().patch_requests;
    asked.insert(asked.end(), wanted.begin(), wanted.end());
    CameraFrame& cf = sim_.look().frames[0];
    cf.patches = sim_.trackers[0].cut(cf.frame, wanted);
    sim_.take();
    sim_.place_truly();
  }
  ASSERT_TRUE(camera().tracks.contains(mapped));
  EXPECT_EQ(std::count(asked.begin(), asked.end(), mapped), 0);
  std::sort(asked.begin(), asked.end());
  EXPECT_EQ(std::adjacent_find(asked.begin(), asked.end()), asked.end()) << "each once";
  for (const auto& [id, t] : camera().tracks) {
    const bool old = t.seen.size() > 50 && id != mapped;
    EXPECT_TRUE(!old || std::binary_search(asked.begin(), asked.end(), id));
  }
}

// One camera: no patch tells anything yet.
TEST_F(PatchWriterTest, OnANarrowLinkFewPatchesAreUnderWay) {
  for (int i = 0; i < 4; ++i) next();
  std::set<TrackId> asked;
  for (int i = 0; i < 25; ++i) {
    const PatchWorths worths(sim_.map, sim_.set);
    const MapPatch patch = write([](TrackFrame&) {}, DescriptorRequest::kNone, &worths);
    EXPECT_LE(patch.patch_requests.size(), 1U);
    asked.insert(patch.patch_requests.begin(), patch.patch_requests.end());
    next();
  }
  EXPECT_GE(asked.size(), 20U);
}

TEST_F(PatchWriterTest, PassesTheWishForDescriptorsOn) {
  EXPECT_EQ(write([](TrackFrame&) {}, DescriptorRequest::kAtTracks).descriptor_request, DescriptorRequest::kAtTracks);
  EXPECT_EQ(write().descriptor_request, DescriptorRequest::kNone);
}

// An agent that sees few points is told the directions of its other tracks, once each, until there are points.
TEST_F(PatchWriterTest, WherePointsAreFewDirectionsAreTold) {
  for (int i = 0; i < 6; ++i) next();
  EXPECT_TRUE(write().updated.empty()) << "how far away things are is not known yet";
  sim_.edit.set_scene_depth(camera(), 5);
  const MapPatch first = write();
  ASSERT_GT(first.updated.size(), 30U);
  for (const BoundPoint& b : first.updated) {
    EXPECT_EQ(b.point, PointId());
    EXPECT_EQ(b.state, PointState::kUncertain);
    const ServerTrack& t = camera().tracks.at(b.track);
    const Rigid3& pose = camera().frame_at(t.seen.front().set)->cam_from_world;
    const Eigen::Vector2d px = camera().model.project(pose * b.position.cast<double>());
    EXPECT_THAT(px, test::VectorNear(t.seen.front().undistorted_px.cast<double>(), 0.01)) << "on its first ray";
  }
  next();
  EXPECT_LT(write().updated.size(), first.updated.size() / 2) << "what was told stays";
  const int world_point = in_view_for(2);
  const TrackId track = sim_.track_of(kCam, world_point)->id;
  sim_.add_point(world_point);
  const MapPatch bound = write();
  const auto told = std::ranges::find(bound.updated, track, &BoundPoint::track);
  ASSERT_NE(told, bound.updated.end());
  EXPECT_NE(told->point, PointId());
  int points = 0;
  for (int p = 0; p < world_.size() && points < 80; ++p) {
    const ServerTrack* t = sim_.track_of(kCam, p);
    if (t == nullptr || t->bound()) continue;
    sim_.add_point(p);
    ++points;
  }
  const MapPatch rich = write();
  EXPECT_FALSE(rich.unbound.empty()) << "directions are taken back";
  for (const BoundPoint& b : rich.updated) EXPECT_NE(b.point, PointId());
}

}  // namespace
}  // namespace coslam::patch_writer_test
