// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "common/base/error.h"
#include "deploy/simulation/sensor.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::scene_test {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

std::string test_name(std::string scene) {
  std::replace(scene.begin(), scene.end(), '-', '_');
  return scene;
}

class EveryScene : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Scene> scene_ = make_scene(GetParam(), 1);
};

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, testing::ValuesIn(scene_names()),
                         [](const auto& p) { return test_name(p.param); });

// The ray through a raw pixel, in the world.
Eigen::Vector3d direction_of(const Scene& scene, int camera, const Eigen::Vector2d& raw_px, double t_s) {
  const CameraModel& model = scene.camera(camera);
  const Eigen::Vector3d in_cam = model.normalized_from_pixel(model.undistorted_from_raw(raw_px).value()).homogeneous();
  return scene.cam_from_world(camera, t_s).rotation.conjugate() * in_cam;
}

TEST(MakeScene, UnknownNameIsAUserErrorThatListsTheNames) {
  try {
    make_scene("nowhere", 1);
    FAIL() << "no error";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("nowhere"));
    for (const std::string& name : scene_names()) EXPECT_THAT(error.what(), testing::HasSubstr(name));
  }
}

TEST(MakeScene, TooManyCamerasIsAUserError) { EXPECT_THROW(make_scene("room", 1, 1000), UserError); }

TEST(MakeScene, TakesTheNumbersOfCamerasAndFrames) {
  const auto own = make_scene("room", 1), asked = make_scene("room", 1, 5, 42);
  EXPECT_EQ(own->cameras(), 3);
  EXPECT_EQ(own->frames(), 300);
  EXPECT_EQ(asked->cameras(), 5);
  EXPECT_EQ(asked->frames(), 42);
}

TEST(MakeScene, UsesBothLensModels) {
  const auto scene = make_scene("wall", 1);
  bool radtan = false, equidistant = false;
  for (int i = 0; i < scene->cameras(); ++i) {
    EXPECT_FALSE(problem_of(scene->camera(i)).has_value());
    radtan |= scene->camera(i).distortion == DistortionModel::kRadTan;
    equidistant |= scene->camera(i).distortion == DistortionModel::kEquidistant;
  }
  EXPECT_TRUE(radtan && equidistant);
}

TEST_P(EveryScene, EveryPixelHasARay) {
  for (int i = 0; i < scene_->cameras(); ++i) {
    const CameraModel& model = scene_->camera(i);
    const Eigen::Vector2d last(model.width_px - 0.5, model.height_px - 0.5);
    for (const Eigen::Vector2d& corner : {Eigen::Vector2d(-0.5, -0.5), last, Eigen::Vector2d(-0.5, last.y())}) {
      const auto undistorted = model.undistorted_from_raw(corner);
      ASSERT_TRUE(undistorted.has_value());
      EXPECT_NEAR((model.raw_from_undistorted(*undistorted) - corner).norm(), 0, 1e-6);
    }
    const double left = model.normalized_from_pixel(*model.undistorted_from_raw({0, model.cy})).x();
    const double right = model.normalized_from_pixel(*model.undistorted_from_raw({model.width_px - 1.0, model.cy})).x();
    const double across_deg = (std::atan(right) - std::atan(left)) * kDegPerRad;
    EXPECT_NEAR(across_deg, GetParam() == "atrium" ? 121 : 77.5, 3.5);
  }
}

// How fast a camera may go and turn.
struct Pace {
  double speed_m_s = 1.9, turn_deg_s = 60;
};
Pace pace_of(const std::string& scene) {
  if (scene == "street") return {17.5, 60};  // 60 km/h
  if (scene == "atrium") return {4.5, 150};
  return {};
}

TEST_P(EveryScene, MovesSmoothlyAndStartsSlowly) {
  constexpr double kStepS = 1e-3;
  const Pace pace = pace_of(GetParam());
  for (int i = 0; i < scene_->cameras(); ++i) {
    double last_speed = NAN;
    for (double t = 0; t < scene_->frames() / scene_->rate_hz(); t += 0.005) {
      const Rigid3 a = scene_->cam_from_world(i, t), b = scene_->cam_from_world(i, t + kStepS);
      const double speed = (a.center() - b.center()).norm() / kStepS;
      const double turn = so3_log(b.rotation * a.rotation.conjugate()).norm() / kStepS * kDegPerRad;
      ASSERT_LT(turn, pace.turn_deg_s) << "camera " << i << " at " << t;
      const double change = std::isnan(last_speed) ? 0 : std::abs(speed - last_speed);
      ASSERT_LT(change, 0.05) << "camera " << i << " at " << t;
      ASSERT_LT(speed, t < 0.05 ? 0.25 : pace.speed_m_s) << "camera " << i << " at " << t;
      last_speed = speed;
    }
  }
}

TEST_P(EveryScene, StaysClearOfThings) {
  const auto crowd = make_scene(GetParam(), 1, sim::kMaxCameras);
  for (int i = 0; i < crowd->cameras(); ++i) {
    for (int frame = 0; frame < crowd->frames(); frame += 10) {
      const double t_s = frame / crowd->rate_hz();
      const Eigen::Vector3d center = crowd->cam_from_world(i, t_s).center();
      for (int k = 0; k < 200; ++k) {
        const double z = -0.99 + 0.01 * k, angle = 2.4 * k;  // a spiral over the sphere
        const double flat = std::sqrt(1 - z * z);
        const auto hit = crowd->cast(center, {flat * std::cos(angle), flat * std::sin(angle), z}, t_s);
        ASSERT_TRUE(hit.has_value()) << "the world has a hole";
        ASSERT_GT(hit->distance_m, 0.3) << "camera " << i << " frame " << frame;
      }
    }
  }
}

TEST_P(EveryScene, CastMeetsSurfacesThatFaceTheViewer) {
  for (int i = 0; i < scene_->cameras(); ++i) {
    const Rigid3 pose = scene_->cam_from_world(i, 2.0);
    for (double y = 20; y < scene_->camera(i).height_px; y += 40) {
      for (double x = 20; x < scene_->camera(i).width_px; x += 40) {
        const Eigen::Vector3d direction = direction_of(*scene_, i, {x, y}, 2.0);
        const auto hit = scene_->cast(pose.center(), direction, 2.0);
        ASSERT_TRUE(hit.has_value());
        EXPECT_NEAR(hit->normal.norm(), 1, 1e-9);
        EXPECT_LE(hit->normal.dot(direction), 0);
        EXPECT_GT(hit->object, 0U);
        EXPECT_EQ(scene_->can_move(hit->object), hit->object >= sim::kFirstMovingObject);
        EXPECT_NEAR((hit->point - pose.center()).norm(), hit->distance_m, 1e-9);
        const Eigen::Vector2d raw_px =
            scene_->camera(i).raw_from_undistorted(scene_->camera(i).project(pose * hit->point));
        EXPECT_NEAR((raw_px - Eigen::Vector2d(x, y)).norm(), 0, 1e-6);
      }
    }
  }
}

// Share of a grid of camera a's pixels whose surface camera b sees too.
double overlap(const Scene& scene, int a, int b, double t_s) {
  const Rigid3 pose_a = scene.cam_from_world(a, t_s), pose_b = scene.cam_from_world(b, t_s);
  int seen = 0, all = 0;
  for (double y = 20; y < 480; y += 40) {
    for (double x = 20; x < 640; x += 40) {
      ++all;
      const auto hit = scene.cast(pose_a.center(), direction_of(scene, a, {x, y}, t_s), t_s);
      if (!hit) continue;
      const Eigen::Vector3d in_b = pose_b * hit->point;
      if (in_b.z() < 0.1 || std::hypot(in_b.x(), in_b.y()) > 1.2 * in_b.z()) continue;
      if (!scene.camera(b).contains_raw(scene.camera(b).raw_from_undistorted(scene.camera(b).project(in_b)))) continue;
      const auto back = scene.cast(pose_b.center(), hit->point - pose_b.center(), t_s);
      if (back && std::abs(back->distance_m - (hit->point - pose_b.center()).norm()) < 0.02) ++seen;
    }
  }
  return static_cast<double>(seen) / all;
}

class SceneOfOneGroup : public EveryScene {};

INSTANTIATE_TEST_SUITE_P(Scenes, SceneOfOneGroup,
                         testing::Values("room", "wall", "walking-man", "sitting-man", "garden"),
                         [](const auto& p) { return test_name(p.param); });

TEST_P(SceneOfOneGroup, CamerasStartSideBySideLookingAtTheSamePlace) {
  for (int i = 1; i < scene_->cameras(); ++i) {
    const double apart_m = (scene_->cam_from_world(i, 0).center() - scene_->cam_from_world(i - 1, 0).center()).norm();
    EXPECT_GT(apart_m, 0.4);
    EXPECT_LT(apart_m, 0.8);
    EXPECT_GT(overlap(*scene_, i - 1, i, 0), 0.5);
  }
  EXPECT_GT(overlap(*scene_, 0, scene_->cameras() - 1, 0), 0.4);
}

TEST_P(SceneOfOneGroup, NeighboursKeepSeeingCommonThingsMostOfTheTime) {
  int shared = 0, all = 0;
  for (int frame = 0; frame < scene_->frames(); frame += 15) {
    for (int i = 1; i < scene_->cameras(); ++i) {
      shared += overlap(*scene_, i - 1, i, frame / scene_->rate_hz()) > 0.25 ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GT(shared, 0.8 * all);
}

TEST(MakeScene, AnotherRateIsTheSameMotion) {
  const auto own = sim::make_simulated_scene("room", 1, {}),
             slow = sim::make_simulated_scene("room", 1, {.rate_hz = 10}),
             cut = sim::make_simulated_scene("room", 1, {.frames = 7, .rate_hz = 10});
  EXPECT_EQ(slow->rate_hz(), 10);
  EXPECT_EQ(slow->frames(), own->frames() / 3);
  EXPECT_EQ(cut->frames(), 7);
  EXPECT_EQ(slow->time_s(50), own->time_s(150));
  EXPECT_TRUE(slow->cam_from_world(1, 2.5).translation == own->cam_from_world(1, 2.5).translation);
}

TEST(MakeScene, AnotherSizeSeesTheSameAcross) {
  const auto own = sim::make_simulated_scene("room", 1, {}),
             wide = sim::make_simulated_scene("room", 1, {.width_px = 1280, .height_px = 720});
  for (int i = 0; i < own->cameras(); ++i) {
    const CameraModel &a = own->camera(i), &b = wide->camera(i);
    EXPECT_EQ(b.width_px, 1280);
    EXPECT_EQ(b.height_px, 720);
    EXPECT_NEAR(b.fx, 2 * a.fx, 1e-9);
    // The middle row of both looks the same way.
    const auto angle = [](const CameraModel& c) { return c.normalized_from_pixel({0, 0.5 * (c.height_px - 1)}).y(); };
    EXPECT_NEAR(angle(a), angle(b), 1e-9);
  }
}

TEST(MakeScene, CanTurnRoundOnTheSpot) {
  const auto own = sim::make_simulated_scene("room", 1, {}),
             turned = sim::make_simulated_scene("room", 1, {.turn_at_s = 4});
  EXPECT_EQ(turned->frames(), own->frames() + 135);
  const auto looks = [&](double t_s) {
    return Eigen::Vector3d(turned->cam_from_world(1, t_s).rotation.conjugate() * Eigen::Vector3d::UnitZ());
  };
  const Eigen::Vector3d before = looks(4), after = looks(4 + sim::kTurnS);
  EXPECT_NEAR((after - Eigen::Vector3d(-before.x(), -before.y(), before.z())).norm(), 0, 1e-9);
  for (double t_s = 4; t_s <= 4 + sim::kTurnS; t_s += 0.1) {
    EXPECT_NEAR((turned->cam_from_world(1, t_s).center() - turned->cam_from_world(1, 4).center()).norm(), 0, 1e-9);
  }
  EXPECT_NEAR((turned->cam_from_world(1, 3).center() - own->cam_from_world(1, 3).center()).norm(), 0, 1e-9);
  // Later it is where it would have been, that much later.
  const double lost_s = sim::kTurnS + sim::kRestS;
  EXPECT_NEAR((turned->cam_from_world(1, 7 + lost_s).center() - own->cam_from_world(1, 7).center()).norm(), 0, 1e-9);
}

TEST(MakeScene, AFisheyeHasItsFieldFromCornerToCorner) {
  const std::map<std::string, int> fields = {{"fisheye60", 60},   {"fisheye120", 120},    {"fisheye150", 150},
                                             {"fisheye170", 170}, {"double_sphere", 150}, {"omni", 150}};
  for (const auto& [lens, field_deg] : fields) {
    const auto scene = sim::make_simulated_scene("room", 1, {.lens = lens});
    const CameraModel& camera = scene->camera(0);
    const auto corner = camera.undistorted_from_raw({-0.5, -0.5});
    ASSERT_TRUE(corner.has_value()) << lens;
    EXPECT_NEAR(2 * std::atan(camera.normalized_from_pixel(*corner).norm()) * kDegPerRad, field_deg, 0.1) << lens;
  }
}

TEST(MakeScene, AnUnknownLensIsAUserErrorThatListsThem) {
  for (const char* lens : {"fisheye", "fisheye59", "fisheye171", "fisheye120x", "fisheye-120", "zoom"}) {
    try {
      sim::make_simulated_scene("room", 1, {.lens = lens});
      FAIL() << lens;
    } catch (const UserError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(sim::known_lenses() + ", fisheye60"));
    }
  }
}

TEST(AtriumScene, TurnsRoundOnTheSpot) {
  const auto scene = make_scene("atrium", 1);
  for (int i = 0; i < scene->cameras(); ++i) {
    double turned_deg = 0;
    const Eigen::Vector3d spot = scene->cam_from_world(i, 13.7).center();
    for (double t = 13.7; t < 17.3; t += 0.02) {
      const Rigid3 a = scene->cam_from_world(i, t), b = scene->cam_from_world(i, t + 0.02);
      turned_deg += so3_log(b.rotation * a.rotation.conjugate()).norm() * kDegPerRad;
      ASSERT_LT((b.center() - spot).norm(), 0.03);
    }
    EXPECT_GT(turned_deg, 330);
  }
}

TEST(StreetScene, CarsFollowEachOtherRoundTheBlockAt60KmH) {
  const auto scene = make_scene("street", 1);
  double fastest_m_s = 0, gone_m = 0;
  Eigen::Vector3d last = scene->cam_from_world(0, 0).center();
  for (int frame = 1; frame < scene->frames(); ++frame) {
    const double t_s = frame / scene->rate_hz();
    const Eigen::Vector3d at = scene->cam_from_world(0, t_s).center();
    gone_m += (at - last).norm();
    fastest_m_s = std::max(fastest_m_s, (at - last).norm() * scene->rate_hz());
    EXPECT_NEAR((at - scene->cam_from_world(1, t_s).center()).norm(), 10, 1.5);
    last = at;
  }
  EXPECT_NEAR(fastest_m_s * 3.6, 60, 1);
  EXPECT_GT(gone_m, 400);
  // Past the place where it started.
  EXPECT_NEAR((last - scene->cam_from_world(0, 0).center()).norm(), 30, 3);
}

TEST(WallScene, TurnsOnTheSpotFromFrame180To256) {
  const auto scene = make_scene("wall", 1);
  for (int i = 0; i < scene->cameras(); ++i) {
    const Rigid3 before = scene->cam_from_world(i, 180 / 30.0), after = scene->cam_from_world(i, 256 / 30.0);
    const double turn_deg = so3_log(after.rotation * before.rotation.conjugate()).norm() * kDegPerRad;
    EXPECT_NEAR(turn_deg, 86, 4);
    for (int frame = 180; frame <= 256; ++frame) {
      EXPECT_LT((scene->cam_from_world(i, frame / 30.0).center() - before.center()).norm(), 0.03);
    }
    EXPECT_GT((scene->cam_from_world(i, 100 / 30.0).center() - before.center()).norm(), 0.1);
  }
}

TEST(RoomScene, CamerasWalkAboutEightMetres) {
  const auto scene = make_scene("room", 1);
  for (int i = 0; i < scene->cameras(); ++i) {
    double path_m = 0;
    for (int frame = 1; frame < scene->frames(); ++frame) {
      path_m +=
          (scene->cam_from_world(i, frame / 30.0).center() - scene->cam_from_world(i, (frame - 1) / 30.0).center())
              .norm();
    }
    EXPECT_NEAR(path_m, 8, 1);
  }
}

TEST(RoomScene, SeedChangesTheThingsButNotThePlan) {
  const auto a = make_scene("room", 1), b = make_scene("room", 2), again = make_scene("room", 1);
  EXPECT_EQ(a->cam_from_world(1, 3.3).translation, again->cam_from_world(1, 3.3).translation);
  const double apart_m = (a->cam_from_world(1, 3.3).center() - b->cam_from_world(1, 3.3).center()).norm();
  EXPECT_GT(apart_m, 0);
  EXPECT_LT(apart_m, 0.05);  // only the shake differs
}

}  // namespace
}  // namespace coslam::scene_test
