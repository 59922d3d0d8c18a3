// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/result_timeline.h"

#include <gmock/gmock.h>

#include <set>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::exporting::result_timeline_test {
namespace {

using ::testing::ElementsAre;

constexpr TimeNs kFrame_ns = 100'000'000;

// Two cameras for a second: `a` at ten images a second, `b` at five, which is 4 ms later.
class Timeline : public ::testing::Test {
 protected:
  Timeline() {
    Trajectory a, b;
    for (int i = 0; i <= 10; ++i) {
      a.push_back({i * kFrame_ns, Rigid3(Eigen::Quaterniond::Identity(), {0.1 * i, 0, 0}).inverse()});
      if (i % 2 == 0) b.push_back({i * kFrame_ns + 4'000'000, Rigid3()});
    }
    save_tum(result_.trajectory("a"), a);
    save_tum(result_.trajectory("b"), b);
  }
  ResultTimeline read() const { return timeline_of(contents_of(result_)); }
  void report(const char* text) const { temp_.write("result/report.json", text); }

  test::TempFolder temp_;
  ResultFolder result_{temp_ / "result"};
};

TEST_F(Timeline, PosesThatAreAlmostOfOneInstantAreTogether) {
  const ResultTimeline timeline = read();
  ASSERT_EQ(timeline.instants.size(), 11U);
  for (std::size_t i = 0; i < timeline.instants.size(); ++i) {
    EXPECT_EQ(timeline.instants[i].poses.size(), i % 2 == 0 ? 2U : 1U) << i;
    EXPECT_EQ(timeline.instants[i].t_ns, static_cast<TimeNs>(i) * kFrame_ns + (i % 2 == 0 ? 4'000'000 : 0)) << i;
  }
}

TEST_F(Timeline, NoInstantHasAnAgentTwice) {
  Trajectory fast;
  for (int i = 0; i < 8; ++i) fast.push_back({i * 3'000'000LL, Rigid3()});
  save_tum(result_.trajectory("a"), fast);
  const ResultTimeline timeline = read();
  std::size_t poses = 0;
  for (const auto& instant : timeline.instants) {
    std::set<std::string> agents;
    for (const PublicPose& pose : instant.poses) EXPECT_TRUE(agents.insert(pose.agent).second);
    poses += instant.poses.size();
  }
  EXPECT_EQ(poses, 8U + 6U) << "and none is left out";
}

TEST_F(Timeline, AnAgentHasItsRateAndItsEnd) {
  const ResultTimeline timeline = read();
  ASSERT_EQ(timeline.agents.size(), 2U);
  EXPECT_EQ(timeline.agents[0].name, "a");
  EXPECT_NEAR(timeline.agents[0].rate_hz, 10, 1e-9);
  EXPECT_NEAR(timeline.agents[1].rate_hz, 5, 1e-9);
  EXPECT_EQ(timeline.agents[0].last_ns, 10 * kFrame_ns);
  EXPECT_NE(timeline.agents[0].run, timeline.agents[1].run);
  EXPECT_NE(timeline.agents[0].run, RunId()) << "0 would be none";
  save_tum(result_.trajectory("a"), {{0, Rigid3()}});
  save_tum(result_.trajectory("b"), {});
  const ResultTimeline brief = read();
  EXPECT_EQ(brief.agents[0].rate_hz, 0);
  EXPECT_EQ(brief.agents[1].last_ns, 0);
  EXPECT_EQ(brief.instants.size(), 1U);
}

TEST_F(Timeline, FactsOfTheReportAreTaken) {
  report(R"({"server": {"scale_known": true, "ms": {"frame_set": {"mean": 12.5}}},
             "agents": {"a": {"ms_per_frame": 7.5, "path": {"quality": "good", "why": "it is", "length": 3.5, "sigma": 0.1},
                              "camera": {"width_px": 640, "height_px": 480, "fx": 400, "fy": 401, "cx": 320, "cy": 240}},
                        "b": {}}})");
  const ResultTimeline timeline = read();
  EXPECT_TRUE(timeline.scale_known);
  EXPECT_EQ(timeline.ms_per_set, 12.5);
  EXPECT_EQ(timeline.agents[0].frame_ms, 7.5);
  EXPECT_EQ(timeline.agents[0].camera.width_px, 640);
  EXPECT_EQ(timeline.agents[0].camera.fy, 401);
  ASSERT_TRUE(timeline.agents[0].path);
  EXPECT_EQ(timeline.agents[0].path->verdict.why, "it is");
  EXPECT_EQ(timeline.agents[0].path->length, 3.5);
  EXPECT_EQ(timeline.agents[0].path->sigma, 0.1);
  EXPECT_FALSE(timeline.agents[1].path);
  EXPECT_EQ(timeline.agents[1].camera.width_px, 0);
}

TEST_F(Timeline, AReportOfOtherValuesThanExpectedIsReadAsFarAsItGoes) {
  for (
      const char* text :
      {R"({"agents": {"a": {}, "b": {}}})", R"({"agents": {"a": 3, "b": null}, "server": 7})",
       R"({"agents": {"a": {"ms_per_frame": "x", "camera": [1], "path": 4}, "b": {}}, "server": {"scale_known": "yes"}})",
       R"({"agents": {"a": {"path": {"quality": 5}}, "b": {"path": {"quality": "good", "why": 1, "length": "far"}}},
            "server": {"ms": {"frame_set": 5}}})"}) {
    report(text);
    const ResultTimeline timeline = read();
    EXPECT_EQ(timeline.agents.size(), 2U) << text;
    EXPECT_EQ(timeline.instants.size(), 11U) << text;
    EXPECT_FALSE(timeline.scale_known) << text;
    EXPECT_EQ(timeline.ms_per_set, 0) << text;
  }
}

TEST_F(Timeline, ACameraThatNobodyDescribedHoldsAllItsTracks) {
  TrackWriter tracks(result_.tracks("b"));
  tracks.write({FrameId(0), 4'000'000, TrackId(1), {611.5, 20}, PointId(3), PointState::kUncertain});
  tracks.write({FrameId(0), 4'000'000, TrackId(2), {20, 433.9}, PointId(), std::nullopt});
  tracks.write({FrameId(2), 204'000'000, TrackId(2), {22, 430}, PointId(4), PointState::kDynamic});
  tracks.close();
  const ResultTimeline timeline = read();
  const CameraModel& camera = timeline.agents[1].camera;
  EXPECT_EQ(camera.width_px, 612);
  EXPECT_EQ(camera.height_px, 434);
  EXPECT_EQ(camera.fx, camera.width_px) << "of a usual lens";
  ASSERT_EQ(timeline.images.size(), 2U);
  const PublicImage& image = timeline.images.at(4'000'000).at(0);
  EXPECT_EQ(image.agent, "b");
  ASSERT_EQ(image.tracks.size(), 2U);
  EXPECT_EQ(image.tracks[0].state, PublicTrackState::kUncertain);
  EXPECT_EQ(image.tracks[1].state, PublicTrackState::kNone);
  EXPECT_EQ(timeline.images.at(204'000'000).at(0).tracks.at(0).state, PublicTrackState::kDynamic);
}

TEST_F(Timeline, PointsOfAllMapsComeByTheTimeAtWhichTheyWereSeen) {
  const ResultFolder apart = result_.of_map(MapId(4));
  save_tum(apart.trajectory("b"), {{0, Rigid3()}});
  const auto write = [](const ResultFolder& folder, std::initializer_list<std::pair<std::uint32_t, TimeNs>> ids) {
    PointWriter points(folder.points());
    for (const auto& [id, first_ns] : ids) {
      ResultPoint p;
      p.id = PointId(id);
      p.first_ns = first_ns;
      p.views = id == 5 ? 100'000 : 2;
      p.covariance = 0.03 * Eigen::Matrix3d::Identity();
      p.state = id == 9 ? PointState::kDynamic : id == 6 ? PointState::kUncertain : PointState::kStatic;
      points.write(p);
    }
    points.close();
  };
  write(result_, {{5, 300}, {9, 0}, {6, 100}});
  write(apart, {{7, 200}});
  const ResultTimeline timeline = read();
  std::vector<std::uint32_t> order;
  for (const auto& [t_ns, point] : timeline.points) order.push_back(point.id.value);
  EXPECT_THAT(order, ElementsAre(6, 7, 5)) << "moving ones are elsewhere";
  EXPECT_TRUE(timeline.points[0].second.on_trial);
  EXPECT_EQ(timeline.points[1].second.map, MapId(4));
  EXPECT_EQ(timeline.points[2].second.views, 65535);
  EXPECT_NEAR(timeline.points[2].second.sigma, 0.3F, 1e-6F);
  EXPECT_EQ(timeline.maps, 2U);
}

TEST_F(Timeline, MovingPointsKnowTheirObject) {
  DynamicWriter moving(result_.dynamic());
  ObjectWriter objects(result_.objects());
  for (const std::uint32_t id : {3U, 4U}) moving.write({500, PointId(id), {1, 1, 1}, Eigen::Matrix3d::Identity(), 2});
  moving.write({900, PointId(3), {1, 1, 2}, Eigen::Matrix3d::Identity(), 2});
  objects.write({500, ObjectId(7), {1, 1, 1}, {0, 0, 1}, {1, 1, 1}, {PointId(3)}});
  moving.close();
  objects.close();
  const ResultTimeline timeline = read();
  ASSERT_EQ(timeline.moving.size(), 2U);
  const auto& now = timeline.moving.at(500).maps.at(timeline.main);
  ASSERT_EQ(now.points.size(), 2U);
  EXPECT_EQ(now.points[0].object, ObjectId(7));
  EXPECT_EQ(now.points[1].object, ObjectId());
  EXPECT_EQ(now.objects.size(), 1U);
  EXPECT_EQ(timeline.moving.at(900).maps.at(timeline.main).points.at(0).object, ObjectId()) << "it was one then";
}

TEST_F(Timeline, ABrokenFileIsTold) {
  temp_.write("result/points.csv", "no header\n");
  EXPECT_THAT(test::error_of<UserError>([&] { read(); }), ::testing::HasSubstr("points.csv"));
}

}  // namespace
}  // namespace coslam::exporting::result_timeline_test
