// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What is told of a whole run against the map that came of it.
#include <gmock/gmock.h>

#include <memory>
#include <set>
#include <string>

#include "server/keep/explain/life.h"
#include "server/keep/observe/result_store.h"
#include "tests/support/sim_run.h"
#include "tests/support/temp_folder.h"

namespace coslam::explain::explain_run_test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// Three cameras among things that move, with tracks that break and slide, and one that is started anew.
class ExplainedRun : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    temp_ = std::make_unique<test::TempFolder>();
    run_ = std::make_unique<test::SimRun>(world(), MapServerConfig(),
                                          test::TrackingConfig{.noise_px = 0.5, .outliers = 0.02, .ends = 0.02});
    ResultStore store(temp_->path());
    for (const auto& path : test::paths_side_by_side(3)) run_->add_agent(path);
    for (int i = 0; i < 160; ++i) {
      if (i == 100) run_->restart(CameraId(2));
      run_->step();
      store.record({run_->map().now(), run_->map().now_ns(), {}}, run_->server());
    }
    run_->server().finish();
    store.finish(run_->server(), {});
    log_ = std::make_unique<EventLog>(read_event_log(result().events()));
  }
  static void TearDownTestSuite() {
    log_.reset();
    run_.reset();
    temp_.reset();
  }
  static const test::SimWorld& world() {
    static const test::SimWorld kWorld({.points = 350, .moving_points = 80});
    return kWorld;
  }
  static ResultFolder result() { return ResultFolder(temp_->path()); }
  static std::string first_line_at_the_end(const Life& life) {
    const std::string text = told_at(*log_, life, run_->map().now_ns());
    return text.substr(0, text.find('\n'));
  }

  static std::unique_ptr<test::TempFolder> temp_;
  static std::unique_ptr<test::SimRun> run_;
  static std::unique_ptr<EventLog> log_;
};

std::unique_ptr<test::TempFolder> ExplainedRun::temp_;
std::unique_ptr<test::SimRun> ExplainedRun::run_;
std::unique_ptr<EventLog> ExplainedRun::log_;

std::string words_of(PointPhase phase) {
  return phase == PointPhase::kTrial ? "on trial" : phase == PointPhase::kStatic ? "static" : "moving";
}

TEST_F(ExplainedRun, EveryPointOfTheResultIsTold) {
  const auto points = read_points(result().points());
  ASSERT_GT(points.size(), 200U);
  EXPECT_EQ(log_->end, EventLog::End::kRunIsOver);
  for (const ResultPoint& p : points) {
    const auto life = life_of_point(*log_, p.id);
    ASSERT_TRUE(life) << p.id.value;
    EXPECT_TRUE(life->alive) << p.id.value;
    EXPECT_EQ(life->last, p.id);
    EXPECT_THAT(life->entries.front().text, StartsWith("It was made, "));
  }
}

TEST_F(ExplainedRun, EveryLifeEndsAsTheMapHasIt) {
  int removed = 0, fused = 0;
  std::set<PointId> alive;
  for (const auto& [id, events] : log_->of_point) {
    const auto life = life_of_point(*log_, id);
    ASSERT_TRUE(life);
    const MapPoint* p = run_->map().find(life->last);
    ASSERT_EQ(life->alive, p != nullptr) << id.value;
    fused += life->last != id;
    const std::string is = first_line_at_the_end(*life);
    if (p == nullptr) {
      ++removed;
      EXPECT_THAT(is, HasSubstr("no longer in the map"));
      EXPECT_THAT(life_text(*log_, *life), ContainsRegex("It was removed because .*\n$")) << id.value;
      continue;
    }
    alive.insert(life->last);
    EXPECT_THAT(is, HasSubstr(" was " + words_of(p->phase) + ", in map " + std::to_string(p->map.value)));
    for (const BoundTrack& b : p->bound) {
      EXPECT_THAT(is, HasSubstr(run_->map().camera(b.camera).name + "/" + std::to_string(b.track.value))) << id.value;
    }
  }
  EXPECT_EQ(run_->map().points().size(), alive.size());
  EXPECT_GT(removed, 10);
  EXPECT_GT(fused, 0);
}

TEST_F(ExplainedRun, EveryTrackIsWhatTheMapHas) {
  int moving = 0;
  for (const MapCamera& c : run_->map().cameras()) {
    for (const auto& [id, track] : c.tracks) {
      const auto life = life_of_track(*log_, {log_->camera_named(c.name), id});
      // Nothing ever happened to it, or to what has the number of one before the restart.
      const bool known = life && life->alive;
      if (!known && !track.bound() && track.motion == TrackMotion::kResting) continue;
      ASSERT_TRUE(life) << c.name << "/" << id.value;
      EXPECT_TRUE(known);
      const MapPoint* p = run_->map().find(track.point);
      const std::string is = p == nullptr ? std::string(track.moves()                            ? "moving"
                                                        : track.motion == TrackMotion::kDoubtful ? "doubtful"
                                                                                                 : "unmapped")
                             : p->moves() ? "moving, with point " + std::to_string(p->id.value)
                                          : "mapped, as point " + std::to_string(p->id.value);
      moving += track.moves();
      EXPECT_THAT(first_line_at_the_end(*life), HasSubstr(" was " + is + "."));
    }
  }
  EXPECT_GT(moving, 10);
}

TEST_F(ExplainedRun, EveryCameraIsWhereTheMapHasIt) {
  for (const MapCamera& c : run_->map().cameras()) {
    const auto life = life_of_camera(*log_, log_->camera_named(c.name));
    ASSERT_TRUE(life) << c.name;
    EXPECT_THAT(first_line_at_the_end(*life), HasSubstr(" was in map " + std::to_string(c.map.value)));
  }
  const auto again = life_of_camera(*log_, log_->camera_named(run_->map().camera(CameraId(2)).name));
  EXPECT_THAT(life_text(*log_, *again), HasSubstr("It joined because its agent was started anew"));
}

}  // namespace
}  // namespace coslam::explain::explain_run_test
