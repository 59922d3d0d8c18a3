// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
// What moves in the scenes, as the cameras and the truth have it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>

#include "deploy/simulation/marked_spots.h"
#include "deploy/simulation/person.h"
#include "deploy/simulation/renderer.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim::moving_test {
namespace {

constexpr int kThreads = 2;

Eigen::Vector3d direction_of(const Scene& scene, int camera, const Eigen::Vector2d& raw_px, double t_s) {
  const CameraModel& model = scene.camera(camera);
  const Eigen::Vector3d in_cam = model.normalized_from_pixel(model.undistorted_from_raw(raw_px).value()).homogeneous();
  return scene.cam_from_world(camera, t_s).rotation.conjugate() * in_cam;
}

struct Seen {
  RayHit hit;
  SurfaceSpot spot;
};

// The moving things that a camera sees through a grid of pixels.
std::vector<Seen> bodies_in_view(const Scene& scene, int camera, double t_s, double step_px) {
  std::vector<Seen> out;
  const Eigen::Vector3d center = scene.cam_from_world(camera, t_s).center();
  for (double y = 5; y < scene.camera(camera).height_px; y += step_px) {
    for (double x = 5; x < scene.camera(camera).width_px; x += step_px) {
      const auto hit = scene.cast(center, direction_of(scene, camera, {x, y}, t_s), t_s);
      if (hit && scene.can_move(hit->object)) out.push_back({*hit, scene.spot(*hit, t_s)});
    }
  }
  return out;
}

class MovingScene : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<SimulatedScene> scene_ = make_simulated_scene(GetParam(), 1, {0, 0, 0.25});
};
INSTANTIATE_TEST_SUITE_P(Scenes, MovingScene, testing::Values("walking-man", "sitting-man", "garden"),
                         [](const auto& p) {
                           std::string name = p.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(MovingScene, ASpotIsWhereTheRayMetIt) {
  const double t_s = 2.0;
  const auto seen = bodies_in_view(*scene_, 1, t_s, 3);
  ASSERT_GE(seen.size(), 20U);
  for (const Seen& s : seen) EXPECT_NEAR((scene_->position(s.spot, t_s) - s.hit.point).norm(), 0, 1e-9);
}

TEST_P(MovingScene, ASpotIsSeenAgainWhereItWent) {
  constexpr double kNowS = 2.0, kLaterS = 2.1;
  const auto seen = bodies_in_view(*scene_, 1, kNowS, 2);
  const Eigen::Vector3d center = scene_->cam_from_world(1, kLaterS).center();
  int again = 0;
  for (const Seen& s : seen) {
    const Eigen::Vector3d there = scene_->position(s.spot, kLaterS);
    const auto hit = scene_->cast(center, there - center, kLaterS);
    ASSERT_TRUE(hit.has_value());
    EXPECT_LT(hit->distance_m, (there - center).norm() + 0.02);  // met there, or hidden behind something
    if (hit->object == s.spot.object && (hit->point - there).norm() < 1e-4) ++again;
  }
  EXPECT_GT(again, 0.8 * static_cast<double>(seen.size()));
}

TEST_P(MovingScene, VelocityIsTheChangeOfThePosition) {
  constexpr double kStepS = 1e-3, kNowS = 3.3;
  for (const SurfaceSpot& spot : marked_spots(*scene_, 40, 1)) {
    const Eigen::Vector3d moved = scene_->position(spot, kNowS + kStepS) - scene_->position(spot, kNowS - kStepS);
    EXPECT_NEAR((scene_->velocity_m_s(spot, kNowS) - moved / (2 * kStepS)).norm(), 0, 5e-3);
  }
}

TEST_P(MovingScene, TheVelocityOfABodyIsThatOfItsSurface) {
  constexpr double kNowS = 3.3;
  std::map<std::string, std::pair<Eigen::Vector3d, int>> sums;  // by body
  const auto spots = marked_spots(*scene_, 3000, 1);
  for (const SurfaceSpot& spot : spots) {
    auto& [sum_m_s, count] = sums.try_emplace(scene_->body(spot.object), Eigen::Vector3d::Zero(), 0).first->second;
    sum_m_s += scene_->velocity_m_s(spot, kNowS);
    ++count;
  }
  for (const SurfaceSpot& spot : spots) {
    const auto& [sum_m_s, count] = sums.at(scene_->body(spot.object));
    ASSERT_NEAR((scene_->body_velocity_m_s(spot.object, kNowS) - sum_m_s / count).norm(), 0, 0.1);
  }
}

TEST_P(MovingScene, MarkedSpotsAreOnAllBodiesAndComeFromTheSeed) {
  const auto spots = marked_spots(*scene_, 300, 1), again = marked_spots(*scene_, 300, 1);
  const auto other = marked_spots(*scene_, 300, 2);
  ASSERT_EQ(spots.size(), 300U);
  ASSERT_EQ(again.size(), 300U);
  std::set<std::uint32_t> objects;
  for (std::size_t i = 0; i < spots.size(); ++i) {
    objects.insert(spots[i].object);
    EXPECT_EQ(spots[i].in_object, again[i].in_object);
  }
  EXPECT_NE(spots[0].in_object, other[0].in_object);
  EXPECT_GE(objects.size(), scene_->parts().size() * 2 / 3);
  const auto same = make_simulated_scene(GetParam(), 1, {0, 0, 0.25});
  EXPECT_EQ(scene_->position(spots[7], 4.4), same->position(spots[7], 4.4));
}

TEST_P(MovingScene, TheMaskIsWhatMovesAtThePixel) {
  constexpr double kTimeS = 1.7, kCoarseness = 12;
  const Renderer renderer(scene_->world(), scene_->caster(), scene_->parts(), kThreads, kCoarseness);
  for (int camera = 0; camera < 2; ++camera) {
    const RayTable rays(scene_->camera(camera), kThreads);
    const Rigid3 pose = scene_->cam_from_world(camera, kTimeS);
    const auto posed = scene_->posed(kTimeS);
    cv::Mat1b mask;
    renderer.radiance(rays, pose, posed.get(), &mask);
    const cv::Mat1w depth = renderer.depth_mm(rays, pose, posed.get());
    int moving = 0, wrong = 0, wrong_depth = 0;
    for (int y = 0; y < mask.rows; ++y) {
      for (int x = 0; x < mask.cols; ++x) {
        const auto hit =
            scene_->cast(pose.center(), direction_of(*scene_, camera, Eigen::Vector2d(x, y), kTimeS), kTimeS);
        ASSERT_TRUE(hit.has_value());
        const bool expected = scene_->moving(scene_->spot(*hit, kTimeS), kTimeS);
        moving += expected ? 1 : 0;
        wrong += (mask(y, x) != 0) != expected ? 1 : 0;
        wrong_depth += std::abs(depth(y, x) - 1000 * (pose * hit->point).z()) > 0.7 ? 1 : 0;
      }
    }
    EXPECT_GT(moving, 60);
    EXPECT_LT(wrong, 0.08 * moving);  // pixels on the outline
    EXPECT_LE(wrong_depth, mask.rows * mask.cols / 200);
  }
}

TEST(WalkingMan, BodiesHaveNames) {
  const auto scene = make_simulated_scene("walking-man", 1, {});
  const auto first_of_cart = static_cast<std::uint32_t>(kFirstMovingObject + scene->first_part(1));
  EXPECT_EQ(scene->body(kFirstMovingObject), "person 1");
  EXPECT_EQ(scene->body(first_of_cart - 1), "person 1");
  EXPECT_EQ(scene->body(first_of_cart), "cart 2");
  EXPECT_EQ(scene->body(1), "");
}

TEST(WalkingMan, IsStaticWhileHeRests) {
  const auto scene = make_simulated_scene("walking-man", 1, {});
  const auto spots = marked_spots(*scene, 100, 1);
  const auto man = [&](const SurfaceSpot& s) { return s.object < kFirstMovingObject + scene->first_part(1); };
  int resting = 0, cart_rolling = 0, between = 0;
  for (int frame = 0; frame < scene->frames(); ++frame) {
    const double t_s = scene->time_s(frame);
    int moving = 0, all = 0, cart = 0;
    for (const SurfaceSpot& s : spots) {
      if (man(s)) {
        ++all;
        moving += scene->moving(s, t_s) ? 1 : 0;
      } else {
        cart += scene->moving(s, t_s) ? 1 : 0;
      }
    }
    if (moving == 0) ++resting;
    if (cart > 0) ++cart_rolling;
    if (moving > 0 && moving < all / 2) ++between;
  }
  EXPECT_LT(between, 20);  // more than half of a man who walks moves
  EXPECT_GT(resting, 3 * 30);
  EXPECT_LT(resting, 7 * 30);
  EXPECT_GT(cart_rolling, 3 * 30);
  EXPECT_LT(cart_rolling, 7 * 30);
}

TEST(WalkingMan, IsTwoToFiveMetresFromTheCameras) {
  const auto scene = make_simulated_scene("walking-man", 1, {});
  for (int frame = 0; frame < scene->frames(); frame += 5) {
    const double t_s = scene->time_s(frame);
    for (int i = 0; i < scene->cameras(); ++i) {
      const double away_m =
          (scene->posed(t_s)->world_from_part(0).translation - scene->cam_from_world(i, t_s).center()).norm();
      EXPECT_GT(away_m, 1.6) << "camera " << i << " frame " << frame;
      EXPECT_LT(away_m, 5.8) << "camera " << i << " frame " << frame;
    }
  }
}

TEST(SittingMan, TwoCamerasSeeHimAndTextureInOneCornerForThreeSeconds) {
  const auto scene = make_simulated_scene("sitting-man", 1, {0, 0, 0.5});
  const Renderer renderer(scene->world(), scene->caster(), scene->parts(), kThreads, 3);
  const auto static_corners = [&](int camera, int frame) {
    const double t_s = scene->time_s(frame);
    const Rigid3 pose = scene->cam_from_world(camera, t_s);
    const auto man_at = [&](double x, double y) {
      const auto hit = scene->cast(pose.center(), direction_of(*scene, camera, Eigen::Vector2d(x, y), t_s), t_s);
      return hit && scene->can_move(hit->object);
    };
    const cv::Mat1b image =
        expose(renderer.radiance(RayTable(scene->camera(camera), kThreads), pose, scene->posed(t_s).get()),
               scene->at(camera).sensor, frame, t_s);
    std::vector<cv::Point2f> corners, out;
    cv::goodFeaturesToTrack(image, corners, 1000, 0.05, 5);
    for (const cv::Point2f& c : corners) {
      if (!man_at(c.x, c.y)) out.push_back(c);
    }
    return out;
  };
  for (const int camera : {2, 3}) {
    const auto at_start = static_corners(camera, 0).size();
    for (const int frame : {150, 195, 240}) {
      const auto corners = static_corners(camera, frame);
      const CameraModel& model = scene->camera(camera);
      const auto in_corner = std::count_if(corners.begin(), corners.end(), [&](const cv::Point2f& c) {
        return c.x < 0.25 * model.width_px && c.y < 0.4 * model.height_px;
      });
      EXPECT_LT(corners.size(), at_start / 4) << camera << " frame " << frame;
      EXPECT_GE(in_corner, 5) << camera << " frame " << frame;
      EXPECT_LE(static_cast<int>(corners.size()) - in_corner, 12) << camera << " frame " << frame;  // at his outline
      const double share = static_cast<double>(bodies_in_view(*scene, camera, scene->time_s(frame), 4).size()) /
                           (scene->camera(camera).width_px / 4.0 * scene->camera(camera).height_px / 4.0);
      EXPECT_GT(share, 0.09) << camera << " frame " << frame;
    }
  }
  EXPECT_GT(static_corners(0, 195).size(), 0.6 * static_cast<double>(static_corners(0, 0).size()));
}

TEST(SittingMan, TheTorsoNeverRests) {
  const auto scene = make_simulated_scene("sitting-man", 1, {});
  auto spots = marked_spots(*scene, 300, 1);
  std::erase_if(spots, [](const SurfaceSpot& s) { return s.object != kFirstMovingObject + kTorso; });
  for (int frame = 120; frame <= 270; frame += 5) {
    std::vector<double> speeds_m_s;
    for (const SurfaceSpot& s : spots) speeds_m_s.push_back(scene->speed_m_s(s, scene->time_s(frame)));
    const auto middle = speeds_m_s.begin() + static_cast<std::ptrdiff_t>(speeds_m_s.size() / 2);
    std::nth_element(speeds_m_s.begin(), middle, speeds_m_s.end());
    EXPECT_GT(*middle, 0.03) << "frame " << frame;
  }
}

TEST(Garden, EveryCameraWalksSixtyThreeMetresAndComesBack) {
  const auto scene = make_simulated_scene("garden", 1, {});
  for (int i = 0; i < scene->cameras(); ++i) {
    double path_m = 0;
    const auto center = [&](int frame) { return scene->cam_from_world(i, scene->time_s(frame)).center(); };
    for (int frame = 5; frame < scene->frames(); frame += 5) path_m += (center(frame) - center(frame - 5)).norm();
    EXPECT_NEAR(path_m, 63, 2);
    EXPECT_LT((center(0) - center(scene->frames() - 1)).norm(), 0.2);
  }
}

TEST(Garden, PeopleOftenFillMuchOfAView) {
  const auto scene = make_simulated_scene("garden", 1, {0, 0, 0.25});
  int views = 0, crowded = 0;
  for (int frame = 0; frame < scene->frames(); frame += 60) {
    for (int i = 0; i < scene->cameras(); ++i) {
      constexpr double kStepPx = 8;
      const auto seen = bodies_in_view(*scene, i, scene->time_s(frame), kStepPx).size();
      ++views;
      crowded += static_cast<double>(seen) > 0.12 * (160 / kStepPx) * (120 / kStepPx) ? 1 : 0;
    }
  }
  EXPECT_GT(crowded, views / 4);
}

TEST(Garden, PeopleDoNotWalkThroughEachOther) {
  const auto scene = make_simulated_scene("garden", 1, {});
  for (int frame = 0; frame < scene->frames(); frame += 3) {
    const auto posed = scene->posed(scene->time_s(frame));
    for (int a = 0; a < scene->bodies(); ++a) {
      for (int b = a + 1; b < scene->bodies(); ++b) {
        const Eigen::Vector3d apart = posed->world_from_part(scene->first_part(a)).translation -
                                      posed->world_from_part(scene->first_part(b)).translation;
        EXPECT_GT(apart.norm(), 0.5) << a << " and " << b << " in frame " << frame;
      }
    }
  }
}

}  // namespace
}  // namespace coslam::sim::moving_test
