// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/evaluation.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "common/base/error.h"
#include "common/dataset/calibration.h"
#include "deploy/coslam/eval/evaluation_json.h"
#include "deploy/coslam/eval/evaluation_text.h"
#include "tests/support/temp_folder.h"

namespace coslam::eval::evaluation_test {
namespace {

using ::testing::HasSubstr;

const CameraModel kCamera{640, 480, 400, 400, 320, 240, DistortionModel::kRadTan, {-0.2, 0.05, 0, 0}};

// A wall at z = 5 and, before it, a plate at z = 3 that moves along x with 0.5 m/s.
class WallScene : public Scene {
 public:
  int cameras() const override { return 2; }
  int frames() const override { return kFrames; }
  double rate_hz() const override { return 10; }
  const CameraModel& camera(int) const override { return kCamera; }
  Rigid3 cam_from_world(int camera, double t_s) const override {
    const Eigen::Vector3d center(camera == 0 ? -1 : 1, 0.5 * std::sin(t_s), 0.3 * t_s);
    return Rigid3(so3_exp({0, 0.02 * t_s, 0}), center).inverse();
  }
  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                             double t_s) const override {
    if (direction.z() <= 0) return std::nullopt;
    const Eigen::Vector3d on_plate = origin + direction * ((3 - origin.z()) / direction.z());
    const bool plate = std::abs(on_plate.x() - 0.5 * t_s) < 0.4 && std::abs(on_plate.y()) < 0.4;
    const Eigen::Vector3d hit =
        plate ? on_plate : Eigen::Vector3d(origin + direction * ((5 - origin.z()) / direction.z()));
    return RayHit{hit, -Eigen::Vector3d::UnitZ(), plate ? 1U : 0U, (hit - origin).norm()};
  }
  std::string body(std::uint32_t object) const override { return object == 1 ? "plate" : ""; }
  Eigen::Vector3d velocity_m_s(const SurfaceSpot& spot, double) const override {
    return {spot.object == 1 ? 0.5 : 0, 0, 0};
  }
  static constexpr int kFrames = 31;
};

// A result that is right but for known errors, in a map with half the truth's scale.
class ResultOfWall : public ::testing::Test {
 protected:
  ResultOfWall() {
    save_calibration(temp_ / "calib.yaml", kCamera);
    sequence_.name = "wall";
    sequence_.rate_hz = 10;
    for (int c = 0; c < 2; ++c) {
      const std::string name = "cam" + std::to_string(c);
      Trajectory truth, estimate;
      for (int i = 0; i < WallScene::kFrames; ++i) {
        const TimeNs t_ns = i * 100'000'000LL;
        truth.push_back({t_ns, scene_.cam_from_world(c, to_seconds(t_ns))});
        if (i > 0) estimate.push_back({t_ns, transform_world(truth.back().cam_from_world, kTruthFromMap.inverse())});
      }
      save_tum(temp_ / (name + ".tum"), truth);
      save_tum(result_.trajectory(name), estimate);
      save_tum(result_.live(name), estimate);
      sequence_.agents.push_back({.name = name, .calibration = temp_ / "calib.yaml", .truth = temp_ / (name + ".tum")});
    }
    write_points();
  }

  // Points 1..20 on the wall, 1 cm off along z in truth, sigma 1 cm; point 99 follows the plate, 2 cm off.
  void write_points() {
    PointWriter points(result_.points());
    DynamicWriter dynamic(result_.dynamic());
    TrackWriter tracks0(result_.tracks("cam0")), tracks1(result_.tracks("cam1"));
    for (std::uint32_t id = 1; id <= 20; ++id) {
      const Eigen::Vector3d on_wall(-1.5 + 0.15 * id, id % 2 == 0 ? 1.2 : -1.2, 5);
      ResultPoint point;
      point.id = PointId(id);
      point.position = kTruthFromMap.inverse() * (on_wall + Eigen::Vector3d(0, 0, 0.01));
      point.covariance = Eigen::Matrix3d::Identity() * (0.01 * 0.01 / 4);
      points.write(point);
      observe(tracks0, 0, on_wall, on_wall, point.id, PointState::kStatic);
      observe(tracks1, 1, on_wall, on_wall, point.id, PointState::kStatic);
    }
    observe(tracks0, 0, {0, 0.1, 3}, {1.5, 0.1, 3}, PointId(99), PointState::kDynamic);
    for (int i = 0; i < WallScene::kFrames; ++i) {
      const Eigen::Vector3d on_plate(0.05 * i, 0.1, 3);
      dynamic.write({i * 100'000'000LL, PointId(99), kTruthFromMap.inverse() * (on_plate + Eigen::Vector3d(0, 0.02, 0)),
                     Eigen::Matrix3d::Identity(), 2});
    }
    points.close(), dynamic.close(), tracks0.close(), tracks1.close();
  }

  // Every tenth frame; the observed spot moves evenly from one place to another.
  void observe(TrackWriter& writer, int camera, const Eigen::Vector3d& from, const Eigen::Vector3d& to, PointId id,
               PointState state) {
    for (std::uint32_t frame = 0; frame < WallScene::kFrames; frame += 10) {
      const double s = frame / (WallScene::kFrames - 1.0);
      const Eigen::Vector3d in_cam = scene_.cam_from_world(camera, 0.1 * frame) * ((1 - s) * from + s * to);
      const Eigen::Vector2d raw_px = kCamera.raw_from_undistorted(kCamera.project(in_cam));
      writer.write({FrameId(frame), frame * 100'000'000LL, TrackId(id.value), raw_px, id, state});
    }
  }

  test::TempFolder temp_;
  const Similarity3 kTruthFromMap{2, so3_exp({0.3, 0, 0.5}), {1, 2, 3}};
  WallScene scene_;
  ResultFolder result_{temp_ / "result"};
  Sequence sequence_;
};

TEST_F(ResultOfWall, AllFigures) {
  const auto agents = load_paths(result_, sequence_);
  const Evaluation e = evaluate(result_, sequence_, agents, &scene_);
  ASSERT_TRUE(e.ate_m);
  EXPECT_LT(*e.ate_m, 1e-6);
  EXPECT_NEAR(e.alignment.target_from_source->scale, 2, 1e-6);
  EXPECT_NEAR(*e.tracked_percent, 100.0 * 30 / 31, 1e-9);
  EXPECT_NEAR(*e.path_m, 2 * path_length(agents[0].truth), 1e-9);
  EXPECT_LT(*e.live_ate_m, 1e-6);
  EXPECT_LT(e.motion->translation_rmse_m, 1e-6);
  EXPECT_NEAR(e.relative_pose->baseline_m, 2, 1e-6);
  EXPECT_NEAR(e.relative_pose->translation, 1, 1e-6);  // the map is half as large
  EXPECT_LT(e.relative_pose->translation_scaled, 1e-6);

  ASSERT_TRUE(e.points);
  EXPECT_EQ(e.points->count, 20);
  EXPECT_EQ(e.points->without_truth, 0);
  EXPECT_NEAR(e.points->error_median_m, 0.01, 1e-4);
  EXPECT_NEAR(e.points->nees_median, 1, 0.02);
  ASSERT_TRUE(e.dynamic_surface_error_m);
  EXPECT_EQ(e.dynamic_surface_error_m->count, 4);
  EXPECT_NEAR(e.dynamic_surface_error_m->median, 0.02, 1e-3);
  ASSERT_TRUE(e.dynamic_relative_error);
  EXPECT_NEAR(e.dynamic_relative_error->median, 0.02 / 3, 1e-3);
  EXPECT_DOUBLE_EQ(*e.dynamic_length_s, 3);
  ASSERT_EQ(e.bodies.count("plate"), 1U);
  EXPECT_EQ(e.bodies.at("plate").instants, 0);  // one track of one camera is not enough
  EXPECT_FALSE(e.dynamic_error_m);
  EXPECT_FALSE(e.classification);
}

TEST_F(ResultOfWall, UnknownFiguresAreNull) {
  for (SequenceAgent& agent : sequence_.agents) agent.truth.reset();
  const auto json = to_json(evaluate(result_, sequence_, load_paths(result_, sequence_), nullptr));
  for (const char* key : {"ate_m", "ate_percent", "scale", "path_m", "truth_spread_m", "rpe", "tracked_percent",
                          "relative_pose", "points", "nees", "classification", "dynamic_error_m",
                          "dynamic_relative_error", "dynamic_coverage", "object_found", "object_velocity_error_m_s"}) {
    ASSERT_TRUE(json.contains(key)) << key;
    EXPECT_TRUE(json[key].is_null()) << key;
  }
  EXPECT_EQ(json["agents"]["cam0"]["poses"], 30);
  EXPECT_TRUE(json["agents"]["cam0"]["ate_m"].is_null());
  EXPECT_EQ(json["problem"], "fewer than three pairs");
}

TEST_F(ResultOfWall, AnErrorAsLargeAsTheSpreadOfTheTruthIsSaidToSayLittle) {
  const auto told = [&] { return to_text(evaluate(result_, sequence_, load_paths(result_, sequence_), nullptr)); };
  EXPECT_THAT(told(), ::testing::Not(HasSubstr("says LITTLE")));
  for (int c = 0; c < 2; ++c) {  // places that have nothing to do with the truth
    Trajectory estimate;
    for (int i = 0; i < WallScene::kFrames; ++i) {
      const Eigen::Vector3d center(std::sin(7.0 * i), std::cos(5.0 * i + c), std::sin(3.0 * i));
      estimate.push_back({i * 100'000'000LL, Rigid3(Eigen::Quaterniond::Identity(), center)});
    }
    save_tum(result_.trajectory("cam" + std::to_string(c)), estimate);
  }
  const Evaluation e = evaluate(result_, sequence_, load_paths(result_, sequence_), nullptr);
  EXPECT_NEAR(*e.truth_spread_m, *e.ate_m, 0.3 * *e.ate_m);
  EXPECT_EQ(to_json(e)["truth_spread_m"], *e.truth_spread_m);
  EXPECT_THAT(told(), HasSubstr("this says LITTLE of where the cameras were"));
}

// Maps that met in the last moment have one frame, though their cameras were in no group yet.
TEST_F(ResultOfWall, TruthThatIsNotWhatItSeemsIsSaid) {
  const auto told = [&] { return to_text(evaluate(result_, sequence_, load_paths(result_, sequence_), nullptr)); };
  const std::filesystem::path file = *sequence_.agents[0].truth;
  const Trajectory truth = load_tum(file);
  EXPECT_THAT(told(), ::testing::Not(::testing::AnyOf(HasSubstr("judged on"), HasSubstr("the truth of"))));

  save_tum(file, Trajectory(truth.begin(), truth.begin() + 11));
  EXPECT_THAT(told(), HasSubstr("cam0 is judged on 10 of 30 poses, 0.9 of 2.9 s"));

  Trajectory late = truth;
  for (StampedPose& pose : late) pose.t_ns += 400'000'000;
  save_tum(file, late);
  EXPECT_THAT(told(), HasSubstr("the truth of agent cam0 fits best 0.40 s earlier"));

  Trajectory turning, estimate;
  std::string swapped;
  for (const StampedPose& pose : truth) {
    const double t_s = to_seconds(pose.t_ns);
    turning.push_back({pose.t_ns, {so3_exp({0.2 * t_s, 0.3, 0.1 * t_s * t_s}), pose.cam_from_world.translation}});
    const Rigid3 w = turning.back().cam_from_world.inverse();
    const Eigen::Quaterniond& q = w.rotation;
    for (const double v : {t_s, w.translation.x(), w.translation.y(), w.translation.z(), q.w(), q.x(), q.y(), q.z()})
      swapped += std::to_string(v) + " ";
    swapped += "\n";
    estimate.push_back({pose.t_ns, transform_world(turning.back().cam_from_world, kTruthFromMap.inverse())});
  }
  save_tum(result_.trajectory("cam0"), estimate);
  save_tum(file, turning);
  EXPECT_THAT(told(), ::testing::Not(HasSubstr("the turns of the truth")));
  temp_.write("cam0.tum", swapped);
  EXPECT_THAT(told(), HasSubstr("the turns of the truth of agent cam0 do not fit ("));
  const auto doubts =
      to_json(evaluate(result_, sequence_, load_paths(result_, sequence_), nullptr))["agents"]["cam0"]["doubts"];
  EXPECT_EQ(doubts.size(), 1U);
}

TEST_F(ResultOfWall, MapsAreThoseOfTheReport) {
  std::ofstream(result_.groups()) << "t_s,group,agents\n0.0,1,cam0\n0.0,2,cam1\n";
  const nlohmann::json agents{{"cam0", {{"frames", 31}}}, {"cam1", {{"frames", 31}}}};
  const auto maps = [&] { return evaluate(result_, sequence_, load_paths(result_, sequence_), nullptr).maps.size(); };
  write_json(result_.report(), {{"agents", agents}});
  EXPECT_EQ(maps(), 2U) << "nothing else tells";
  write_json(result_.report(),
             {{"agents", agents}, {"maps", {{{"map", 1}, {"agents", {{"cam0", 30}, {"cam1", 30}}}}}}});
  EXPECT_EQ(maps(), 1U);
}

TEST_F(ResultOfWall, MarkedPointsAndReportedFrames) {
  std::string marked = "t_s,id,x,y,z\n";
  for (int i = 0; i <= 30; ++i) marked += std::to_string(0.1 * i) + ",plate," + std::to_string(0.05 * i) + ",0.1,3\n";
  sequence_.truth_points = temp_.write("points.csv", marked);
  write_json(result_.report(), {{"agents", {{"cam0", {{"frames", 60}}}, {"cam1", {{"frames", 31}}}}}});
  const Evaluation e = evaluate(result_, sequence_, load_paths(result_, sequence_), nullptr);
  ASSERT_TRUE(e.dynamic_error_m);
  EXPECT_NEAR(e.dynamic_error_m->median, 0.02, 1e-5);
  EXPECT_EQ(e.dynamic_error_m->count, 31);
  EXPECT_EQ(e.agents[0].tracked_percent, 50);
  EXPECT_FALSE(e.points);  // without a scene nobody knows where the points are
}

TEST_F(ResultOfWall, AgentsThatDidNotTakePartDoNotCount) {
  std::filesystem::remove(result_.trajectory("cam1"));
  EXPECT_EQ(load_paths(result_, sequence_).size(), 2u);  // it may have been lost from the start
  write_json(result_.report(), {{"agents", {{"cam0", {{"frames", 31}}}}}});
  const auto agents = load_paths(result_, sequence_);
  ASSERT_EQ(agents.size(), 1u);
  EXPECT_FALSE(evaluate_paths(agents, 10).relative_pose);
  std::filesystem::remove(result_.trajectory("cam0"));
  EXPECT_THAT(test::error_of<UserError>([&] { load_paths(result_, sequence_); }),
              HasSubstr("there is no trajectory/<agent>.tum"));
}

TEST_F(ResultOfWall, FilesOfAnotherRunDoNotCount) {
  write_json(result_.report(),
             {{"agents", {{"cam0", {{"frames", 31}}}}}, {"maps", {{{"map", 1}, {"agents", {{"cam0", 30}}}}}}});
  const auto agents = load_paths(result_, sequence_);  // the folder has paths of cam1 too
  ASSERT_EQ(agents.size(), 1u);
  EXPECT_EQ(agents[0].name, "cam0");
}

TEST_F(ResultOfWall, AnotherMapIsJudgedByItself) {
  save_tum(result_.of_map(MapId(5)).trajectory("cam1"), load_tum(result_.trajectory("cam1")));
  save_tum(result_.trajectory("cam1"), {});
  write_json(result_.report(),
             {{"agents", {{"cam0", {{"frames", 31}}}, {"cam1", {{"frames", 31}}}}},
              {"maps", {{{"map", 1}, {"agents", {{"cam0", 30}}}}, {{"map", 5}, {"agents", {{"cam1", 30}}}}}}});
  GroupWriter groups(result_.groups());
  groups.write({0, GroupId(1), {"cam0"}});
  groups.write({0, GroupId(2), {"cam1"}});
  groups.close();
  const Evaluation e = evaluate(result_, sequence_, load_paths(result_, sequence_), nullptr);
  ASSERT_EQ(e.agents.size(), 2u);
  EXPECT_NEAR(*e.agents[0].tracked_percent, 100.0 * 30 / 31, 1e-9);
  EXPECT_EQ(e.agents[1].tracked_percent, 0) << "of the common map";
  EXPECT_EQ(e.agents[1].poses_apart, 30);
  ASSERT_EQ(e.maps.size(), 2u);
  EXPECT_EQ(e.maps[1].id, MapId(5));
  EXPECT_EQ(e.maps[1].agents, AgentNames{"cam1"});
  EXPECT_LT(*e.maps[1].ate_m, 1e-6);
}

TEST_F(ResultOfWall, TextFitsAScreen) {
  const std::string text = to_text(evaluate(result_, sequence_, load_paths(result_, sequence_), &scene_));
  EXPECT_THAT(text, HasSubstr("joint ATE 0.0000 m"));
  EXPECT_THAT(text, HasSubstr("static points: 0.0100 m median"));
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 24);
}

}  // namespace
}  // namespace coslam::eval::evaluation_test
