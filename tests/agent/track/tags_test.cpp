// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/tags.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "common/base/error.h"
#include "common/geometry/rigid3.h"

namespace coslam::tags_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr const char* kFamily = "DICT_APRILTAG_36h11";
constexpr int kCells = 8;

CameraModel camera(DistortionModel distortion = DistortionModel::kNone) {
  CameraModel c;
  c.width_px = 640, c.height_px = 480;
  c.fx = 458, c.fy = 457, c.cx = 321, c.cy = 238;
  c.distortion = distortion;
  if (distortion == DistortionModel::kRadTan) c.coefficients = {-0.27, 0.06, 1e-4, -2e-4};
  return c;
}

// A print in front of the camera: the tag is `side_m` wide and lies in the plane z = 0 of its own frame, x right, y
// down from its middle, with a margin of one cell.
struct Print {
  int id = 0;
  double side_m = 0.2;
  Rigid3 cam_from_print;

  std::array<Vector3d, 4> corners() const {
    const double h = side_m / 2;
    return {Vector3d(-h, -h, 0), Vector3d(h, -h, 0), Vector3d(h, h, 0), Vector3d(-h, h, 0)};
  }
};

struct Picture {
  double black = 0.05, white = 0.8, wall = 0.4;
  double blur_px = 0.7, gamma = 1.0, noise = 2.0;
};

Rigid3 facing(double distance_m, double turn_rad, double roll_rad = 0, const Vector2d& aside_m = {0, 0}) {
  Rigid3 out;
  out.rotation = Eigen::AngleAxisd(roll_rad, Vector3d::UnitZ()) * Eigen::AngleAxisd(turn_rad, Vector3d::UnitY());
  out.translation = {aside_m.x(), aside_m.y(), distance_m};
  return out;
}

// Exact reflectance at 5 x 5 places a pixel, then lens, gamma and noise.
cv::Mat photograph(const CameraModel& c, const std::vector<Print>& prints, const Picture& picture) {
  constexpr int kSub = 5;
  const auto dictionary = aruco::dictionary_of(cv::aruco::DICT_APRILTAG_36h11);
  cv::Mat1f light(c.height_px, c.width_px, static_cast<float>(picture.wall));
  for (const Print& p : prints) {
    cv::Mat cells;
    aruco::draw(dictionary, p.id, &cells);
    const Eigen::Matrix3d r = p.cam_from_print.rotation.toRotationMatrix();
    for (int y = 0; y < c.height_px; ++y) {
      for (int x = 0; x < c.width_px; ++x) {
        double sum = 0;
        bool on = false;
        for (int k = 0; k < kSub * kSub; ++k) {
          const Vector2d raw(x + (k % kSub + 0.5) / kSub - 0.5, y + (k / kSub + 0.5) / kSub - 0.5);
          const Vector2d n = c.normalized_from_pixel(c.undistorted_from_raw(raw).value());
          const Vector3d ray = n.homogeneous();
          const double depth = r.col(2).dot(p.cam_from_print.translation) / r.col(2).dot(ray);
          const Vector3d at = r.transpose() * (depth * ray - p.cam_from_print.translation);
          const int column = static_cast<int>(std::floor((at.x() / p.side_m + 0.5) * kCells));
          const int row = static_cast<int>(std::floor((at.y() / p.side_m + 0.5) * kCells));
          if (std::min(row, column) < -1 || std::max(row, column) > kCells) {
            sum += picture.wall;
            continue;
          }
          on = true;
          const bool paper =
              std::min(row, column) < 0 || std::max(row, column) >= kCells || cells.at<std::uint8_t>(row, column) > 0;
          sum += paper ? picture.white : picture.black;
        }
        if (on) light(y, x) = static_cast<float>(sum / (kSub * kSub));
      }
    }
  }
  cv::GaussianBlur(light, light, {0, 0}, picture.blur_px);
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, picture.noise);
  cv::Mat1b out(light.size());
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x)
      out(y, x) = cv::saturate_cast<std::uint8_t>(255 * std::pow(light(y, x), picture.gamma) + noise(random));
  }
  return out;
}

double worst_corner_px(const CameraModel& c, const Print& p, const FoundTag& found) {
  double worst = 0;
  for (std::size_t k = 0; k < 4; ++k)
    worst = std::max(worst, (c.project(p.cam_from_print * p.corners()[k]) - found.undistorted_px[k]).norm());
  return worst;
}

double side_px(const std::array<Vector2d, 4>& corners) {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) sum += (corners[k] - corners[(k + 1) % 4]).norm() / 4;
  return sum;
}

TEST(TagFinder, CornersToATenthOfAPixel) {
  const CameraModel c = camera();
  for (const double turn : {-0.9, -0.3, 0.0, 0.6}) {
    for (const double distance_m : {0.5, 0.8, 1.5, 2.5}) {
      if (distance_m * std::abs(turn) > 2) continue;  // cells of less than 2 px
      const Print p{.id = 17, .cam_from_print = facing(distance_m, turn, 0.4, {0.1, -0.05})};
      const auto found = TagFinder(c, kFamily).find(photograph(c, {p}, {}));
      ASSERT_EQ(found.size(), 1U) << turn << " " << distance_m;
      EXPECT_EQ(found[0].tag, TagId(17));
      EXPECT_LT(worst_corner_px(c, p, found[0]), 0.1) << turn << " " << distance_m;
    }
  }
}

TEST(TagFinder, TheLensMayBendItsSides) {
  const CameraModel c = camera(DistortionModel::kRadTan);
  const Print p{.id = 3, .cam_from_print = facing(0.9, 0.3, -0.2, {0.35, 0.25})};
  const auto found = TagFinder(c, kFamily).find(photograph(c, {p}, {}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_LT(worst_corner_px(c, p, found[0]), 0.1);
}

// A tone curve makes black parts look smaller: by half a pixel of 36 here, were only the border looked at.
TEST(TagFinder, GammaDoesNotShrinkIt) {
  const CameraModel c = camera();
  const Print p{.id = 0, .cam_from_print = facing(2.5, 0.2)};
  const auto found = TagFinder(c, kFamily).find(photograph(c, {p}, {.black = 0.02, .blur_px = 0.9, .gamma = 0.45}));
  ASSERT_EQ(found.size(), 1U);
  std::array<Vector2d, 4> truth;
  for (std::size_t k = 0; k < 4; ++k) truth[k] = c.project(p.cam_from_print * p.corners()[k]);
  EXPECT_NEAR(side_px(found[0].undistorted_px) / side_px(truth), 1, 0.004);
}

TEST(TagFinder, ATagPrintedTwiceIsFoundTwice) {
  const CameraModel c = camera();
  const auto image = photograph(c,
                                {{.id = 9, .cam_from_print = facing(1.5, 0, 0, {-0.5, 0})},
                                 {.id = 4, .cam_from_print = facing(1.5, 0)},
                                 {.id = 9, .cam_from_print = facing(1.5, 0, 0, {0.5, 0})}},
                                {});
  const auto found = TagFinder(c, kFamily).find(image);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].tag, TagId(4));
  EXPECT_EQ(found[1].tag, TagId(9));
  EXPECT_EQ(found[2].tag, TagId(9));
}

TEST(TagFinder, NothingInAnEmptyImageOrAnotherFamily) {
  const CameraModel c = camera();
  EXPECT_TRUE(TagFinder(c, kFamily).find(cv::Mat1b(480, 640, std::uint8_t{90})).empty());
  const auto image = photograph(c, {{.id = 9, .cam_from_print = facing(1.5, 0)}}, {});
  EXPECT_TRUE(TagFinder(c, "DICT_4X4_50").find(image).empty());
  EXPECT_THROW(TagFinder(c, "DICT_9X9"), UserError);
}

TEST(TagFinder, AHiddenCornerIsNoCorner) {
  const CameraModel c = camera();
  const Print p{.id = 17, .cam_from_print = facing(1.0, 0.2)};
  cv::Mat image = photograph(c, {p}, {});
  const Vector2d corner = c.project(p.cam_from_print * p.corners()[2]);
  cv::circle(image, {static_cast<int>(corner.x()), static_cast<int>(corner.y())}, 24, 120, cv::FILLED);
  EXPECT_TRUE(TagFinder(c, kFamily).find(image).empty());
}

}  // namespace
}  // namespace coslam::tags_test
