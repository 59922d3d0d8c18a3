// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/agent.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <utility>

#include "agent/agent_config.h"
#include "common/base/error.h"
#include "common/config/config.h"
#include "common/wire/codec.h"
#include "common/wire/reply_parts.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_tracker.h"

namespace coslam::agent_test {
namespace {

using test::SimTracker;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr RunId kRun(5), kServer(9);
constexpr TimeNs kPeriodNs = 33'333'333;

AgentConfig with_tags() {
  AgentConfig config;
  config.tags.family = tag_families().back();
  return config;
}

std::vector<TrackId> ids_of(const TrackFrame& frame) {
  std::vector<TrackId> ids;
  ids.reserve(frame.tracks.size());
  for (const TrackObservation& o : frame.tracks) ids.push_back(o.track);
  return ids;
}

// An agent on a simulated tracker. What the server says is made up here.
class AgentTest : public testing::Test {
 protected:
  explicit AgentTest(const test::TrackingConfig& tracking = {}, const AgentConfig& config = with_tags(),
                     const test::CameraPath& path = test::wave_path({})) {
    auto tracker = std::make_unique<SimTracker>(world_, path, tracking, "cam0", kRun);
    tracker_ = tracker.get();
    agent_ = std::make_unique<Agent>("cam0", kRun, test::sim_camera(), config, std::move(tracker));
  }

  AgentOutput step(const std::vector<MapPatch>& patches = {}, Answers answers = {}) {
    agent_->track({FrameId(next_), time_of(next_), {}});
    ++next_;
    newest_ = agent_->finish(patches, answers);
    return newest_;
  }
  // The server's next patch, about the newest frame.
  MapPatch patch() {
    MapPatch p;
    p.agent = "cam0";
    p.server_run = server_;
    p.agent_run = kRun;
    p.sequence = ++sequence_;
    p.snapshot = sequence_ == 1;
    p.after_frame = newest_.frame.frame;
    p.epoch = epoch_;
    return p;
  }
  // With the true pose of the newest frame and true points for all of its tracks.
  MapPatch placing_patch() {
    MapPatch p = patch();
    p.placed = PlacedPose{newest_.frame.frame, truth()};
    for (const TrackObservation& o : newest_.frame.tracks) {
      const int point = tracker_->point_of(o.track);
      BoundPoint& b = p.updated.emplace_back();
      b.track = o.track;
      b.point = PointId(static_cast<std::uint32_t>(point + 1));
      b.position = world_.position(point).cast<float>();
      b.covariance = pack_covariance(1e-4 * Eigen::Matrix3d::Identity());
    }
    return p;
  }
  void place() {
    step();
    step({placing_patch()});
    ASSERT_EQ(newest_.frame.pose_state, PoseState::kTracked);
  }
  static TimeNs time_of(std::uint32_t frame) { return kPeriodNs * frame; }
  Rigid3 truth() const { return tracker_->truth(newest_.frame.capture_ns); }

  const test::SimWorld world_{{}};
  SimTracker* tracker_ = nullptr;  // the agent's
  std::unique_ptr<Agent> agent_;
  AgentOutput newest_;
  RunId server_ = kServer;
  MapEpoch epoch_;
  std::uint32_t next_ = 0, sequence_ = 0;
};

TEST_F(AgentTest, AFrameIsTheTracksOfItsImage) {
  for (std::uint32_t i = 0; i < 5; ++i) {
    const TrackFrame f = step().frame;
    EXPECT_EQ(f.agent, "cam0");
    EXPECT_EQ(f.agent_run, kRun);
    EXPECT_EQ(f.frame, FrameId(i));
    EXPECT_EQ(f.capture_ns, time_of(i));
    EXPECT_EQ(f.pose_state, PoseState::kNone);
    EXPECT_EQ(f.server_run, RunId());
    ASSERT_THAT(f.tracks, SizeIs(tracker_->live().size()));
    for (std::size_t k = 0; k < f.tracks.size(); ++k) {
      EXPECT_EQ(f.tracks[k].track, tracker_->live()[k].id);
      EXPECT_EQ(f.tracks[k].undistorted_px, tracker_->live()[k].raw_px) << "a camera without distortion";
    }
    EXPECT_EQ(agent_->tracks(), f.tracks.size());
  }
}

TEST_F(AgentTest, PatchesAskedForComeWithTheNextFrameAndOnce) {
  step();
  const std::vector<TrackId> live = ids_of(newest_.frame);
  MapPatch first = patch(), second = patch();
  first.patch_requests = {live[7], live[3]};
  second.patch_requests = {live[3], live[20], TrackId(99999)};
  const AgentOutput out = step({first, second});
  ASSERT_TRUE(out.patches);
  EXPECT_EQ(out.patches->frame, out.frame.frame);
  EXPECT_EQ(out.patches->agent_run, kRun);
  std::vector<TrackId> cut;
  cut.reserve(out.patches->patches.size());
  for (const ImagePatch& p : out.patches->patches) cut.push_back(p.track);
  EXPECT_THAT(cut, testing::ElementsAre(live[3], live[7], live[20])) << "a track that is not live has no patch";
  EXPECT_EQ(out.frame.patches_sent, 3);
  EXPECT_FALSE(step({patch()}).patches);
  EXPECT_EQ(newest_.frame.patches_sent, 0);
}

TEST_F(AgentTest, TheFirstImageIsDescribedAndThenThoseAskedFor) {
  const AgentOutput first = step();
  ASSERT_TRUE(first.descriptors) << "it introduces the agent";
  EXPECT_EQ(first.frame.descriptors_sent, DescriptorsSent::kWithFrame);
  EXPECT_EQ(first.descriptors->frame, first.frame.frame);
  EXPECT_EQ(first.descriptors->descriptors.size(), first.descriptors->tracks.size() * kDescriptorBytes);
  EXPECT_FALSE(step().descriptors);
  EXPECT_EQ(newest_.frame.descriptors_sent, DescriptorsSent::kNone);
  EXPECT_TRUE(step({patch()}).descriptors) << "so does a server that is new to it";
  EXPECT_FALSE(step({patch()}).descriptors);
  MapPatch asks = patch(), says_no_more = patch();
  asks.descriptor_request = DescriptorRequest::kAtTracks;
  const AgentOutput out = step({asks, says_no_more});
  ASSERT_TRUE(out.descriptors) << "a request stands until it is answered";
  EXPECT_LE(out.descriptors->tracks.size(), static_cast<std::size_t>(AgentConfig().place_features));
  EXPECT_THAT(ids_of(out.frame), testing::IsSupersetOf(out.descriptors->tracks));
  EXPECT_FALSE(step({patch()}).descriptors);
}

TEST_F(AgentTest, WhatIsAtTracksMayBeDescribedAfterItsFrame) {
  step();
  step({patch()});
  MapPatch asks = patch();
  asks.descriptor_request = DescriptorRequest::kAtTracks;
  const AgentOutput out = step({asks}, {.later = true});
  EXPECT_FALSE(out.descriptors);
  EXPECT_EQ(out.frame.descriptors_sent, DescriptorsSent::kLater);
  ASSERT_TRUE(out.describe);
  step();
  const DescriptorReply reply = out.describe()();
  EXPECT_EQ(reply.frame, out.frame.frame);
  EXPECT_EQ(reply.agent_run, kRun);
  EXPECT_THAT(reply.tracks, testing::Not(testing::IsEmpty()));
  EXPECT_THAT(ids_of(out.frame), testing::IsSupersetOf(reply.tracks));
}

TEST_F(AgentTest, IsTrackedOncePlacedAndLostWithoutPoints) {
  place();
  EXPECT_EQ(newest_.frame.server_run, kServer);
  EXPECT_GT(newest_.frame.pose_inliers, 50);
  EXPECT_GT(newest_.frame.hull_fraction, 0.3);
  EXPECT_THAT(newest_.frame.cam_from_world, test::PoseNear(truth(), 0.002, 0.01));
  EXPECT_GT(newest_.frame.pose_covariance.diagonal().minCoeff(), 0);
  EXPECT_EQ(agent_->tracked_frames(), 1U);
  step();
  EXPECT_EQ(newest_.frame.pose_state, PoseState::kTracked) << "no patch is needed for that";
  EXPECT_EQ(agent_->tracked_frames(), 2U);
  MapPatch empties = patch();
  empties.snapshot = true;
  step({empties});
  EXPECT_EQ(newest_.frame.pose_state, PoseState::kLost);
  EXPECT_EQ(agent_->tracked_frames(), 2U);
}

TEST_F(AgentTest, GoesAlongWhenTheMapMoves) {
  place();
  const Similarity3 new_from_old{2.0, so3_exp({0, 0.4, 0}), {1, 2, 3}};
  epoch_ = MapEpoch(1);
  MapPatch moves = patch();
  moves.new_from_old = new_from_old;
  step({moves});
  EXPECT_EQ(newest_.frame.epoch, MapEpoch(1));
  EXPECT_EQ(newest_.frame.pose_state, PoseState::kTracked);
  EXPECT_THAT(newest_.frame.cam_from_world, test::PoseNear(transform_world(truth(), new_from_old), 0.002, 0.02));
}

TEST_F(AgentTest, AnotherServerRunFindsItNew) {
  place();
  MapPatch asks = patch();
  asks.patch_requests = {ids_of(newest_.frame)[0]};
  server_ = RunId(10);
  sequence_ = 0;
  step({asks, patch()});
  EXPECT_EQ(newest_.frame.server_run, RunId(10));
  EXPECT_EQ(newest_.frame.pose_state, PoseState::kNone);
  EXPECT_EQ(newest_.frame.applied_patch, 1U);
  EXPECT_EQ(agent_->local_map().size(), 0U);
  EXPECT_FALSE(newest_.patches) << "nobody waits for them any more";
  EXPECT_TRUE(newest_.descriptors) << "it introduces itself again";
}

TEST_F(AgentTest, AsksForASnapshotWhenAPatchIsMissing) {
  place();
  const std::uint32_t before = newest_.frame.applied_patch;
  patch();  // never arrives
  MapPatch asks = patch();
  asks.patch_requests = {ids_of(newest_.frame)[0]};
  step({asks});
  EXPECT_TRUE(newest_.frame.wants_snapshot);
  EXPECT_EQ(newest_.frame.applied_patch, before);
  EXPECT_FALSE(newest_.patches) << "a patch that was not processed asks for nothing";
  MapPatch snapshot = placing_patch();
  snapshot.snapshot = true;
  step({snapshot});
  EXPECT_FALSE(newest_.frame.wants_snapshot);
  EXPECT_EQ(newest_.frame.applied_patch, snapshot.sequence);
  EXPECT_EQ(newest_.frame.pose_state, PoseState::kTracked);
}

TEST_F(AgentTest, PatchesForAnotherRunAreNotItsOwn) {
  step();
  MapPatch p = placing_patch();
  p.agent_run = RunId(77);
  p.descriptor_request = DescriptorRequest::kEverywhere;
  step({p});
  EXPECT_EQ(newest_.frame.server_run, RunId());
  EXPECT_EQ(newest_.frame.applied_patch, 0U);
  EXPECT_FALSE(newest_.descriptors);
}

TEST_F(AgentTest, TagsAreLookedForAFewTimesASecond) {
  tracker_->hang(TagId(3), test::tag_corners({0.5, -0.3, 3.5}, 0.4));
  tracker_->hang(TagId(3), test::tag_corners({-0.5, -0.3, 3.5}, 0.4));
  std::vector<std::uint32_t> frames;
  for (std::uint32_t i = 0; i < 15; ++i) {
    step();
    if (newest_.frame.tags.empty()) continue;
    EXPECT_THAT(newest_.frame.tags, SizeIs(2)) << "one printed twice is there twice";
    frames.push_back(i);
  }
  EXPECT_THAT(frames, testing::ElementsAre(0, 7, 14)) << "0.2 s apart at least";
  for (int i = 0; i < 30; ++i) tracker_->hang(TagId(4), test::tag_corners({0, -0.3, 3.5}, 0.4));
  next_ += 7;
  step();
  EXPECT_THAT(newest_.frame.tags, SizeIs(kMaxTags));
}

class AgentWithoutTags : public AgentTest {
 protected:
  AgentWithoutTags() : AgentTest({}, {}) {}
};

TEST_F(AgentWithoutTags, DoesNotLookForThem) {
  tracker_->hang(TagId(3), test::tag_corners({0.5, -0.3, 3.5}, 0.4));
  EXPECT_THAT(step().frame.tags, IsEmpty());
  EXPECT_FALSE(agent_->times().stages().contains("tags"));
}

class AgentOfFewTracks : public AgentTest {
 protected:
  static constexpr std::size_t kTracks = 50;
  AgentOfFewTracks() : AgentTest({.max_tracks = kTracks}, {}, test::still_path(test::looking({0, 0, 0}))) {}
};

TEST_F(AgentOfFewTracks, WhatIsDescribedEverywhereIsTrackedForAWhile) {
  step();
  std::size_t expected = newest_.descriptors->tracks.size();
  EXPECT_GT(expected, kTracks + 30);
  EXPECT_EQ(ids_of(newest_.frame), newest_.descriptors->tracks) << "of that very image";
  for (int i = 0; i < 20; ++i) EXPECT_THAT(step().frame.tracks, SizeIs(expected));
  while (expected > kTracks) {
    expected = std::max(expected - 15, kTracks);
    ASSERT_THAT(step().frame.tracks, SizeIs(expected));
  }
  EXPECT_THAT(step().frame.tracks, SizeIs(kTracks));
}

// Nothing ever ends of itself; each answer finds features at all tracks, and as many new ones as it may.
class EndlessTracker final : public FeatureTracker {
 public:
  explicit EndlessTracker(std::size_t tracks) : keeps_(tracks) { start(tracks); }
  const std::vector<Track>& step(const Image&) override { return live_; }
  const std::vector<Track>& live() const override { return live_; }
  void thin(int at_most) override {
    for (; at_most > 0 && live_.size() > keeps_; --at_most) live_.pop_back();
  }
  std::vector<ImagePatch> patches(const std::vector<TrackId>& tracks) override {
    std::vector<ImagePatch> out;
    out.reserve(tracks.size());
    for (const TrackId t : tracks) out.push_back({t, {}});
    return out;
  }
  std::function<StartTracks()> describe_strongest(int most) override {
    return [this, most] {
      return [this, most](int most_new) {
        start(static_cast<std::size_t>(std::max(0, std::min(most, most_new))));
        return all();
      };
    };
  }
  std::function<DescribedTracks()> describe_at(const std::vector<TrackId>&, int) override {
    return [described = all()] { return described; };
  }
  std::vector<TagObservation> tags() override { return {}; }

 private:
  DescribedTracks all() const {
    std::vector<TrackId> tracks;
    tracks.reserve(live_.size());
    for (const Track& t : live_) tracks.push_back(t.id);
    return {tracks, std::vector<std::uint8_t>(tracks.size() * kDescriptorBytes)};
  }
  void start(std::size_t tracks) {
    for (std::size_t i = 0; i < tracks; ++i) live_.push_back({TrackId(next_++), {100, 100}, 0});
  }
  std::size_t keeps_;
  std::uint32_t next_ = 1;
  std::vector<Track> live_;
};

MapPatch asking_patch(std::uint32_t sequence, DescriptorRequest request) {
  MapPatch p;
  p.server_run = kServer;
  p.agent_run = kRun;
  p.sequence = sequence;
  p.snapshot = sequence == 1;
  p.descriptor_request = request;
  return p;
}

// Most tracks of a frame while the server asks every sixth image, as it does of an agent without a place.
std::size_t most_tracks(DescriptorRequest request, const AgentConfig& config) {
  Agent agent("cam0", kRun, test::sim_camera(), config,
              std::make_unique<EndlessTracker>(static_cast<std::size_t>(config.tracker.max_tracks)));
  std::size_t most = 0;
  for (std::uint32_t i = 0; i < 100; ++i) {
    agent.track({FrameId(i), kPeriodNs * i, {}});
    const MapPatch asks = asking_patch(i + 1, i % 6 == 0 ? request : DescriptorRequest::kNone);
    most = std::max(most, agent.finish(std::vector{asks}).frame.tracks.size());
  }
  return most;
}

TEST(AgentWithoutAPlace, HasTheTracksOfOneAnswerMoreAndNoMore) {
  const AgentConfig config{.tracker = {.max_tracks = 300}, .descriptor_features = 400};
  EXPECT_EQ(most_tracks(DescriptorRequest::kEverywhere, config), 700U);
  EXPECT_LE(most_tracks(DescriptorRequest::kAtTracks, config), 700U);
}

TEST(AgentFrames, NeverCarryMoreThanTheWire) {
  AgentConfig config;
  config.tracker.max_tracks = 5000;
  config.descriptor_features = 5000;
  Agent agent("cam0", kRun, test::sim_camera(), config, std::make_unique<EndlessTracker>(5000));
  agent.track({FrameId(0), 0, {}});
  MapPatch asks = asking_patch(1, DescriptorRequest::kEverywhere);
  for (std::uint32_t i = 1; i <= 5000; ++i) asks.patch_requests.emplace_back(i);
  const AgentOutput out = agent.finish(std::vector{asks});
  EXPECT_THAT(out.frame.tracks, SizeIs(kMaxTracks));
  EXPECT_EQ(out.frame.tracks.front().track, TrackId(1)) << "the oldest: those that are known";
  EXPECT_TRUE(decode(encode(out.frame, pixel_scale(test::sim_camera()))));
  ASSERT_TRUE(out.patches);
  for (const PatchReply& part : in_parts(*out.patches)) EXPECT_TRUE(decode(encode(part)));
  ASSERT_TRUE(out.descriptors);
  for (const DescriptorReply& part : in_parts(*out.descriptors)) EXPECT_TRUE(decode(encode(part)));
  EXPECT_EQ(out.descriptors->tracks, ids_of(out.frame)) << "of no track that the frame does not have";
}

TEST(AgentConfigBounds, WhatIsLegalFitsIntoAFrame) {
  AgentConfig config;
  config::apply_set(config, "tracker.max_tracks=1024");
  config::apply_set(config, "descriptor_features=1024");
  EXPECT_EQ(static_cast<std::size_t>(config.tracker.max_tracks + config.descriptor_features), kMaxTracks);
  EXPECT_THROW(config::apply_set(config, "tracker.max_tracks=1025"), UsageError);
  EXPECT_THROW(config::apply_set(config, "descriptor_features=1025"), UsageError);
}

}  // namespace
}  // namespace coslam::agent_test
