// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/renderer.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "deploy/simulation/builder.h"
#include "deploy/simulation/lighting.h"
#include "deploy/simulation/motion.h"
#include "deploy/simulation/sensor.h"
#include "deploy/simulation/simulated_scene.h"

namespace coslam::sim::renderer_test {
namespace {

constexpr int kThreads = 2;

// A surface of one tone that shines by itself, so that its image needs no light.
void shining_rect(WorldBuilder& b, const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                  double tone) {
  b.rect(corner, u, v, b.material(MaterialKind::kLamp, tone)).emission = 1;
}

// A board of n x n squares of 1 m / n, in the plane y = 2 around the origin, seen from the origin along +y.
World checker_board(int n) {
  WorldBuilder b(1);
  b.begin({});
  const double side = 1.0 / n;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      shining_rect(b, {-0.5 + i * side, 2, 0.5 - j * side}, {side, 0, 0}, {0, 0, -side}, (i + j) % 2 == 0 ? 0.8 : 0.1);
    }
  }
  return b.world();
}

class EveryLens : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Lenses, EveryLens, testing::Values(0, 1, 2));

TEST_P(EveryLens, CornersLandWhereTheCameraModelSays) {
  const World world = checker_board(4);
  const Caster caster(world);
  const Renderer renderer(world, caster, kThreads);
  const CameraModel camera = simulated_camera(GetParam());
  const Rigid3 pose = cam_from_world({{0.55, 0.9, 0.3}, 105, -14, 6});  // the board reaches into the distorted corners
  cv::Mat1f image = renderer.radiance(RayTable(camera, kThreads), pose);
  cv::Mat1b grey;
  cv::GaussianBlur(image, image, {5, 5}, 0.8);
  image.convertTo(grey, CV_8U, 255);
  Eigen::Vector2d sum(0, 0);
  int checked = 0;
  for (int j = 1; j < 4; ++j) {
    for (int i = 1; i < 4; ++i) {
      const Eigen::Vector3d corner(-0.5 + 0.25 * i, 2, 0.5 - 0.25 * j);
      const Eigen::Vector2d expected = camera.raw_from_undistorted(camera.project(pose * corner));
      if (!camera.contains_raw(expected, 12)) continue;
      std::vector<cv::Point2f> found{{static_cast<float>(expected.x() + 1.3), static_cast<float>(expected.y() - 1.1)}};
      cv::cornerSubPix(grey, found, {8, 8}, {-1, -1}, {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 100, 1e-4});
      const Eigen::Vector2d error = Eigen::Vector2d(found[0].x, found[0].y) - expected;
      EXPECT_LT(error.norm(), 0.15) << i << ' ' << j;  // what the corner finder is good for
      sum += error;
      ++checked;
    }
  }
  EXPECT_GE(checked, 6);
  EXPECT_LT((sum / checked).norm(), 0.05);
}

TEST(Renderer, DepthIsAlongTheOpticalAxis) {
  const World world = checker_board(2);
  const Caster caster(world);
  const Renderer renderer(world, caster, kThreads);
  const cv::Mat1w depth =
      renderer.depth_mm(RayTable(simulated_camera(0), kThreads), cam_from_world({{0, 0, 0}, 90, 0, 0}));
  EXPECT_EQ(depth(240, 320), 2000);
  EXPECT_EQ(depth(200, 400), 2000);
  EXPECT_EQ(depth(5, 5), 0);  // past the board
}

TEST(Texture, DetailFinerThanTheFootprintTurnsGrey) {
  const Texture texture(301, 203, [](int x, int y) { return unit(hash_cell(x, y, 1)); });
  const auto deviation_at = [&](float footprint) {
    double sum = 0, squares = 0;
    for (int i = 0; i < 1000; ++i) {
      const double value = texture.sample(0.1F + 0.0008F * static_cast<float>(i), 0.37F, footprint);
      sum += value;
      squares += value * value;
    }
    return std::sqrt(squares / 1000 - sum * sum / 1e6);
  };
  EXPECT_GT(deviation_at(1), 0.15);
  EXPECT_LT(deviation_at(4), 0.1);
  EXPECT_LT(deviation_at(16), 0.03);
}

TEST(Texture, ReductionsDoNotMoveThePicture) {
  // Odd sizes at every level: halving pairs of texels would shift what is read.
  const Texture ramp(231, 5, [](int x, int) { return static_cast<float>(x) / 230.0F; });
  for (const float footprint : {1.0F, 2.0F, 4.0F, 8.0F}) {
    for (const float u : {0.2F, 0.5F, 0.8F}) EXPECT_NEAR(ramp.sample(u, 0.5F, footprint), (u * 231 - 0.5F) / 230, 1e-3);
  }
}

TEST(LightMap, AThingThrowsAShadow) {
  WorldBuilder b(1);
  b.begin({});
  b.rect({-2, 2, 0}, {4, 0, 0}, {0, -4, 0}, b.material(MaterialKind::kLamp, 0.5));
  b.ceiling_lamp({0, 0, 2.5}, 0.4, 0.4, 20);
  b.box({-0.3, -0.3, 0.5}, {0.3, 0.3, 0.6}, b.material(MaterialKind::kPaint, 0.5));
  World world = b.world();
  world.ambient = 0.05;
  const Caster caster(world);
  const LightMap light(world, caster, world.facets[0], world.facets[0].light_cell_m);
  EXPECT_LT(light.at(0.5F, 0.5F), 0.4F * light.at(0.8F, 0.5F));    // below the box, beside it
  EXPECT_LT(light.at(0.99F, 0.99F), 0.9F * light.at(0.8F, 0.5F));  // farther from the lamp
}

TEST(Sensor, NoiseIsRepeatableAndGrowsWithLight) {
  SensorModel sensor = simulated_sensor(0, 5);
  sensor.vignetting = 0;
  const auto deviation_at = [&](float light) {
    cv::Mat1f flat(100, 100, light);
    cv::Scalar mean, deviation;
    cv::Mat1f linear;
    expose(flat, sensor, 3, 0).convertTo(linear, CV_32F, 1 / 255.0);
    cv::pow(linear, sensor.gamma, linear);
    cv::meanStdDev(linear, mean, deviation);
    return deviation[0];
  };
  EXPECT_GT(deviation_at(0.6F), 1.4 * deviation_at(0.2F));
  const cv::Mat1f flat(60, 80, 0.4F);
  EXPECT_EQ(cv::norm(expose(flat, sensor, 3, 0), expose(flat, sensor, 3, 0), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(expose(flat, sensor, 3, 0), expose(flat, sensor, 4, 0), cv::NORM_INF), 0);
}

// Frames of a whole scene, at reduced detail.
class SceneFrames : public testing::TestWithParam<std::string> {
 protected:
  static constexpr double kCoarseness = 2.5;

  struct Loaded {
    std::unique_ptr<SimulatedScene> scene;
    std::unique_ptr<Renderer> renderer;
  };
  // Textures take a second or two: once for all tests of a scene.
  static const Loaded& loaded(const std::string& name) {
    static std::map<std::string, Loaded> all;
    Loaded& one = all[name];
    if (!one.scene) {
      one.scene = make_simulated_scene(name, 1, {});
      one.renderer = std::make_unique<Renderer>(one.scene->world(), one.scene->caster(), kThreads, kCoarseness);
    }
    return one;
  }

  cv::Mat1b frame(int camera, double t_s) const {
    const RayTable rays(scene_.camera(camera), kThreads);
    return expose(renderer_.radiance(rays, scene_.cam_from_world(camera, t_s)), scene_.at(camera).sensor, 0, t_s);
  }
  std::optional<RayHit> cast_through(int camera, const Eigen::Vector2d& raw_px, double t_s) const {
    const CameraModel& model = scene_.camera(camera);
    const Rigid3 pose = scene_.cam_from_world(camera, t_s);
    const Eigen::Vector3d ray = model.normalized_from_pixel(model.undistorted_from_raw(raw_px).value()).homogeneous();
    return scene_.cast(pose.center(), pose.rotation.conjugate() * ray, t_s);
  }
  // Raw pixel of camera's image of a point that it sees, with a margin.
  std::optional<Eigen::Vector2d> seen_at(int camera, const Eigen::Vector3d& point, double t_s) const {
    const CameraModel& model = scene_.camera(camera);
    const Rigid3 pose = scene_.cam_from_world(camera, t_s);
    const Eigen::Vector3d in_cam = pose * point;
    if (in_cam.z() < 0.2 || std::hypot(in_cam.x(), in_cam.y()) > 1.2 * in_cam.z()) return std::nullopt;
    const Eigen::Vector2d raw_px = model.raw_from_undistorted(model.project(in_cam));
    if (!model.contains_raw(raw_px, 4)) return std::nullopt;
    const auto back = scene_.cast(pose.center(), point - pose.center(), t_s);
    if (!back || (back->point - point).norm() > 1e-3) return std::nullopt;
    return raw_px;
  }
  std::optional<double> patch_zncc(const cv::Mat1b& a, const cv::Mat1b& b, const Eigen::Vector2d& px, double t_s,
                                   const Eigen::Vector2d& shift_px) const;

  const SimulatedScene& scene_ = *loaded(GetParam()).scene;
  const Renderer& renderer_ = *loaded(GetParam()).renderer;
};

double bilinear(const cv::Mat1b& image, const Eigen::Vector2d& px) {
  const int x = static_cast<int>(px.x()), y = static_cast<int>(px.y());
  const double u = px.x() - x, v = px.y() - y;
  return (1 - v) * ((1 - u) * image(y, x) + u * image(y, x + 1)) +
         v * ((1 - u) * image(y + 1, x) + u * image(y + 1, x + 1));
}

// Similarity of a patch of camera 0 with its image in camera 1 by the truth; empty at edges, where hidden, without
// texture.
std::optional<double> SceneFrames::patch_zncc(const cv::Mat1b& a, const cv::Mat1b& b, const Eigen::Vector2d& px,
                                              double t_s, const Eigen::Vector2d& shift_px) const {
  constexpr int kHalf = 6, kValues = (2 * kHalf + 1) * (2 * kHalf + 1);
  const auto middle = cast_through(0, px, t_s);
  Eigen::VectorXd va(kValues), vb(kValues);
  int n = 0;
  for (int dy = -kHalf; dy <= kHalf; ++dy) {
    for (int dx = -kHalf; dx <= kHalf; ++dx) {
      const Eigen::Vector2d at = px + Eigen::Vector2d(dx, dy);
      const auto hit = cast_through(0, at, t_s);
      if (!hit || std::abs((hit->point - middle->point).dot(middle->normal)) > 1e-4) return std::nullopt;
      const auto other = seen_at(1, hit->point, t_s);
      if (!other) return std::nullopt;
      va(n) = bilinear(a, at);
      vb(n++) = bilinear(b, *other + shift_px);
    }
  }
  va.array() -= va.mean();
  vb.array() -= vb.mean();
  constexpr double kTextured = 9.0;  // grey levels of deviation, several times the noise
  if (va.norm() < kTextured * std::sqrt(kValues)) return std::nullopt;
  return va.dot(vb) / (va.norm() * vb.norm() + 1e-9);
}

TEST_P(SceneFrames, TwoCamerasSeeTheSameTextureWhereTheTruthSays) {
  constexpr double kTimeS = 0.5;
  const cv::Mat1b a = frame(0, kTimeS), b = frame(1, kTimeS);
  int patches = 0, good = 0;
  double sum = 0, shifted_sum = 0;
  for (double y = 15; y < 465; y += 18) {
    for (double x = 15; x < 625; x += 18) {
      const auto zncc = patch_zncc(a, b, {x, y}, kTimeS, {0, 0});
      if (!zncc) continue;
      ++patches;
      good += *zncc > 0.8 ? 1 : 0;
      sum += *zncc;
      shifted_sum += patch_zncc(a, b, {x, y}, kTimeS, {1.0, -1.0}).value();
    }
  }
  ASSERT_GE(patches, 40);
  EXPECT_GT(good, 0.95 * patches);
  EXPECT_GT(sum / patches, 0.93);
  EXPECT_LT(shifted_sum / patches, sum / patches - 0.15);  // the test would notice a pixel
}

TEST_P(SceneFrames, RenderedDepthIsWhatCastMeets) {
  const double t_s = 1.0;
  const cv::Mat1w depth = renderer_.depth_mm(RayTable(scene_.camera(2), kThreads), scene_.cam_from_world(2, t_s));
  int differing = 0, all = 0;
  for (int y = 3; y < 480; y += 17) {
    for (int x = 3; x < 640; x += 17) {
      const auto hit = cast_through(2, {x, y}, t_s);
      ASSERT_TRUE(hit.has_value());
      const double z_mm = 1000 * (scene_.cam_from_world(2, t_s) * hit->point).z();
      differing += std::abs(z_mm - depth(y, x)) > 0.6 ? 1 : 0;
      ++all;
    }
  }
  EXPECT_LE(differing, all / 200);  // a ray along an edge may fall on either side
}

TEST_P(SceneFrames, EveryViewHasHundredsOfCornersInAllParts) {
  for (int i = 0; i < 3; ++i) {
    for (const double t_s : {0.0, 4.0, 7.2}) {
      std::vector<cv::Point2f> corners;
      cv::goodFeaturesToTrack(frame(i, t_s), corners, 2000, 0.01, 10);
      EXPECT_GE(corners.size(), 400U) << "camera " << i << " at " << t_s;
      int filled[12] = {};
      for (const cv::Point2f& c : corners) ++filled[static_cast<int>(c.x) / 160 + 4 * (static_cast<int>(c.y) / 160)];
      for (const int count : filled) EXPECT_GE(count, 8) << "camera " << i << " at " << t_s;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, SceneFrames, testing::Values("room", "wall"), [](const auto& p) { return p.param; });

}  // namespace
}  // namespace coslam::sim::renderer_test
