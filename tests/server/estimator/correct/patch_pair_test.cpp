// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <random>

#include "agent/correct/local_map.h"
#include "server/estimator/correct/patch_writer.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"

// PatchWriter and LocalMap as a pair over a channel that loses, delays and repeats, while the map lives.
namespace coslam::patch_pair_test {
namespace {

constexpr CameraId kCam(0);

struct Channel {
  unsigned seed;
  double loss;       // of a patch on its way down, or a frame on its way up
  int delay_frames;  // that a patch is under way
  double restarts;   // chance of a restart of the one side and of the other, per frame
};

class PatchPair {
 public:
  explicit PatchPair(const Channel& channel)
      : channel_(channel), random_(channel.seed), sim_(world_, test::paths_side_by_side(1), {.ends = 0.02}) {
    restart_agent();
    restart_server();
  }

  void step() {
    sim_.ingest();
    sim_.place(kCam, map_id_, transform_world(sim_.truth(kCam, sim_.set.id), map_from_world_));
    live(0.3);
    TrackFrame frame = sim_.set.frames[0].frame;
    deliver();
    frame.agent_run = agent_run_;
    frame.wants_snapshot = agent_->wants_snapshot();
    frame.epoch = agent_->epoch();
    frame.pose_state = agent_world_ ? PoseState::kTracked : PoseState::kNone;
    if (chance() < channel_.loss) return;  // the server never sees the frame, and answers nothing
    MapPatch patch = writer_->begin(sim_.edit, sim_.map.camera(kCam), frame, DescriptorRequest::kNone);
    writer_->fill(sim_.map, sim_.map.camera(kCam), frame, nullptr, &patch);
    Sent sent{std::move(patch), expected(), map_from_world_};
    if (chance() < channel_.loss) return;
    under_way_.push_back(sent);
    if (chance() < channel_.loss) under_way_.push_back(sent);  // twice
    if (chance() < channel_.restarts) restart_agent();
    if (chance() < channel_.restarts) restart_server();
  }
  int accepted() const { return accepted_; }
  int rebased() const { return rebased_; }
  bool agent_knows() const { return agent_world_.has_value(); }

 private:
  using Bindings = std::map<TrackId, LocalMap::Entry>;
  struct Sent {
    MapPatch patch;
    Bindings bound;  // what the server had bound when it wrote it
    Similarity3 map_from_world;
  };

  double chance() { return std::uniform_real_distribution<>(0, 1)(random_); }

  // What stages do to a map.
  void live(double rate) {
    MapEdit& edit = sim_.edit;
    for (const auto& [id, track] : sim_.map.camera(kCam).tracks) {
      if (!track.bound() && chance() < 0.2 * rate) {
        const Eigen::Vector3d at = map_from_world_ * world_.position(sim_.world_point(kCam, id));
        const PointPhase phase = chance() < 0.2 ? PointPhase::kTrial : PointPhase::kStatic;
        sim_.bind(sim_.create(map_id_, at, std::sqrt(chance()), phase), kCam, track);
      } else if (const MapPoint* p = sim_.map.find(track.point)) {
        if (chance() < 0.05 * rate) sim_.shift(*p, {0.1 * chance(), 0, 0});
        if (chance() < 0.05 * rate) edit.move_point(*p, p->position, 0.5 * p->covariance);
        if (chance() < 0.02 * rate) change_phase(*p);
        if (chance() < 0.02 * rate) edit.unbind(kCam, track, Why::kOutsideGate);
      }
    }
    if (chance() < 0.3 * rate) edit.remove_point(sim_.map.points().begin()->second, Why::kTooFewViews);
    if (chance() < 0.2 * rate) {
      const Similarity3 move{0.8 + 0.4 * chance(), so3_exp({0, chance() - 0.5, 0}), {chance(), 0, -chance()}};
      edit.transform(map_id_, move, Why::kAdjusted);
      map_from_world_ = move * map_from_world_;
    }
    if (chance() < 0.1 * rate) edit.raise_epoch();  // another camera's affair
    if (chance() < 0.02 * rate) move_to_a_new_map();
  }

  void change_phase(const MapPoint& p) {
    if (p.phase == PointPhase::kTrial) {
      sim_.edit.prove(p);
    } else if (p.phase == PointPhase::kStatic) {
      sim_.set_moving(p);
    }
  }

  void move_to_a_new_map() {
    sim_.edit.leave_map(sim_.map.camera(kCam));
    map_id_ = sim_.edit.new_map(Why::kStartedAlone, 1);
    map_from_world_ = {1 + chance(), so3_exp({0, 0, chance()}), {chance(), chance(), 5}};
    sim_.place(kCam, map_id_, transform_world(sim_.truth(kCam, sim_.set.id), map_from_world_));
    sim_.edit.raise_epoch();
  }

  void restart_agent() {
    agent_run_ = RunId(1000 + ++runs_);
    agent_ = std::make_unique<LocalMap>(agent_run_);
    agent_world_.reset();
  }
  void restart_server() {
    // Every change passes the image's and the covariance's bounds, so that both sides must agree exactly.
    const CorrectConfig config{.moved_px = 0, .covariance_ratio = 1};
    writer_ = std::make_unique<PatchWriter>(ServerRun{RunId(2000 + ++runs_), std::nullopt}, config);
    sim_.edit.mark_announced(sim_.map.camera(kCam));
  }

  Bindings expected() {
    Bindings out;
    for (const auto& [id, t] : sim_.map.camera(kCam).tracks) {
      const MapPoint* p = sim_.map.find(t.point);
      if (p == nullptr) continue;
      const PointState told = p->phase == PointPhase::kTrial ? PointState::kUncertain : told_state(p->phase);
      out[id] = {p->id, told, p->position, p->covariance};
    }
    return out;
  }

  void deliver() {
    while (static_cast<int>(under_way_.size()) > channel_.delay_frames) {
      const Sent sent = under_way_.front();
      under_way_.pop_front();
      const PatchEffect effect = agent_->apply(sent.patch);
      if (effect.new_server) agent_world_.reset();
      if (!effect.accepted) continue;
      ++accepted_;
      rebased_ += effect.rebase.has_value();
      if (effect.rebase && agent_world_) agent_world_ = *effect.rebase * *agent_world_;
      if (effect.placed) agent_world_ = world_of(*effect.placed, sent);
      agent_->keep_only(sim_.set.frames[0].frame.tracks);
      compare(sent);
    }
    agent_->keep_only(sim_.set.frames[0].frame.tracks);
  }

  // An agent that is told one pose learns where the world is; its scale comes with the points.
  Similarity3 world_of(const PlacedPose& placed, const Sent& sent) {
    const Rigid3 truth = sim_.trackers[0].truth(test::kPeriodNs * placed.frame.value);
    EXPECT_THAT(placed.cam_from_world, test::PoseNear(transform_world(truth, sent.map_from_world), 1e-6, 1e-6));
    return sent.map_from_world;
  }

  void compare(const Sent& sent) {
    std::size_t shared = 0;
    for (const TrackObservation& o : sim_.set.frames[0].frame.tracks) {
      const LocalMap::Entry* mine = agent_->find(o.track);
      const auto theirs = sent.bound.find(o.track);
      ASSERT_EQ(mine != nullptr, theirs != sent.bound.end()) << "track " << o.track.value;
      if (mine == nullptr) continue;
      ++shared;
      ASSERT_EQ(mine->point, theirs->second.point);
      ASSERT_EQ(mine->state, theirs->second.state);
      if (mine->state != PointState::kStatic) continue;                              // its place is not told
      ASSERT_THAT(mine->position, test::VectorNear(theirs->second.position, 2e-4));  // single precision, often re-based
      ASSERT_LT((mine->covariance - theirs->second.covariance).norm(), 1e-4 * (1 + theirs->second.covariance.norm()));
    }
    ASSERT_EQ(agent_->size(), shared);
    ASSERT_EQ(agent_->epoch(), sent.patch.epoch);
    ASSERT_TRUE(agent_world_) << "a snapshot comes with a pose";
    ASSERT_THAT(*agent_world_, test::SimilarityNear(sent.map_from_world, 1e-6, 1e-6, 1e-9));
  }

  Channel channel_;
  std::mt19937_64 random_;
  const test::SimWorld world_{{.points = 200}};
  test::SimMap sim_;
  MapId map_id_ = sim_.id;
  Similarity3 map_from_world_;
  std::unique_ptr<PatchWriter> writer_;
  std::unique_ptr<LocalMap> agent_;
  RunId agent_run_;
  std::optional<Similarity3> agent_world_;
  std::deque<Sent> under_way_;
  unsigned runs_ = 0;
  int accepted_ = 0, rebased_ = 0;
};

void run(const Channel& channel, int least_accepted) {
  PatchPair pair(channel);
  for (int i = 0; i < 300 && !testing::Test::HasFatalFailure(); ++i) pair.step();
  EXPECT_GE(pair.accepted(), least_accepted) << "seed " << channel.seed;
}

TEST(PatchPair, AgreeWithoutLoss) {
  for (unsigned seed = 0; seed < 5; ++seed) run({seed, 0, 0, 0}, 295);
}

TEST(PatchPair, AgreeThroughDelay) {
  for (unsigned seed = 0; seed < 5; ++seed) run({seed, 0, 4, 0}, 290);
}

TEST(PatchPair, AgreeThroughLossAndRepetition) {
  for (unsigned seed = 0; seed < 10; ++seed) run({seed, 0.1, 0, 0}, 150);
  for (unsigned seed = 0; seed < 10; ++seed) run({seed, 0.5, 0, 0}, 20);
  for (unsigned seed = 0; seed < 10; ++seed) run({seed, 0.2, 3, 0}, 60);
}

TEST(PatchPair, AgreeThroughRestartsOfEitherSide) {
  for (unsigned seed = 0; seed < 10; ++seed) run({seed, 0, 0, 0.05}, 200);
  for (unsigned seed = 0; seed < 10; ++seed) run({seed, 0.2, 2, 0.05}, 40);
}

TEST(PatchPair, EpochsRebaseTheAgent) {
  PatchPair pair({.seed = 3, .loss = 0, .delay_frames = 0, .restarts = 0});
  for (int i = 0; i < 100; ++i) pair.step();
  EXPECT_GT(pair.rebased(), 3);
  EXPECT_TRUE(pair.agent_knows());
}

}  // namespace
}  // namespace coslam::patch_pair_test
