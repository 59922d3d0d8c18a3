// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/undistort.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace coslam::exporting::undistort_test {
namespace {

const CameraModel kBarrel{752, 480, 458.654, 457.296, 367.2, 248.4, DistortionModel::kRadTan, {-0.283, 0.074, 0, 0}};
const CameraModel kFisheye{640, 480, 280, 280, 322, 237, DistortionModel::kEquidistant, {0.01, -0.002, 0, 0}};
const CameraModel kSphere{640, 480, 200, 200, 318, 241, DistortionModel::kDoubleSphere, {-0.2, 0.59}};
const CameraModel kPinhole{640, 480, 500, 510, 312, 250, DistortionModel::kNone, {}};

// Of a scene that is a function of the direction: what a camera sees in a pixel.
double brightness(const Eigen::Vector2d& n) { return 128 + 60 * std::sin(6 * n.x()) + 60 * std::cos(5 * n.y()); }

cv::Mat taken_by(const CameraModel& camera) {
  cv::Mat image(camera.height_px, camera.width_px, CV_8U, cv::Scalar(0));
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const auto px = camera.undistorted_from_raw({u, v});
      if (px)
        image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(brightness(camera.normalized_from_pixel(*px)));
    }
  }
  return image;
}

class Undistort : public ::testing::TestWithParam<CameraModel> {};

TEST_P(Undistort, ThePinholeSeesWhatTheLensSaw) {
  const CameraModel& lens = GetParam();
  const CameraModel pinhole = pinhole_of(lens);
  EXPECT_EQ(pinhole.distortion, DistortionModel::kNone);
  EXPECT_DOUBLE_EQ(pinhole.fx, lens.fx);
  EXPECT_DOUBLE_EQ(pinhole.cx, (pinhole.width_px - 1) / 2.0);
  EXPECT_DOUBLE_EQ(pinhole.cy, (pinhole.height_px - 1) / 2.0);
  EXPECT_LE(pinhole.width_px, 2 * std::tan(M_PI / 3) * lens.fx);
  EXPECT_LE(pinhole.height_px, 2 * std::tan(M_PI / 3) * lens.fy);
  EXPECT_GT(pinhole.width_px, 0.9 * lens.width_px);  // the middle keeps its pixels, and not much is cut off
  EXPECT_GT(pinhole.height_px, 0.9 * lens.height_px);

  const cv::Mat seen = Undistorter(lens, pinhole)(taken_by(lens)), expected = taken_by(pinhole);
  double worst = 0;
  for (int v = 0; v < seen.rows; ++v) {
    for (int u = 0; u < seen.cols; ++u)
      worst = std::max<double>(worst, std::abs(seen.at<std::uint8_t>(v, u) - expected.at<std::uint8_t>(v, u)));
  }
  EXPECT_LE(worst, 4) << "grey values; a border without image would be off by more";
}

INSTANTIATE_TEST_SUITE_P(Lenses, Undistort, ::testing::Values(kBarrel, kFisheye, kSphere, kPinhole));

TEST(UndistortModel, DropsWhatThePinholeDoesNotShow) {
  ColmapModel model;
  model.cameras.push_back({{}, kFisheye});
  model.images.resize(2);
  const auto at = [](double right_deg, std::uint32_t point) {
    const Eigen::Vector2d px = kFisheye.pixel_from_normalized({std::tan(right_deg * M_PI / 180), 0});
    return ColmapModel::Observation{kFisheye.raw_from_undistorted(px), PointId(point)};
  };
  for (auto& image : model.images) {
    for (std::uint32_t i = 1; i <= 10; ++i) image.observations.push_back(at(3.0 * i, i));
    image.observations.push_back(at(62, 11));
  }
  for (std::uint32_t i = 1; i <= 11; ++i) model.points[PointId(i)];
  undistort_model(&model);
  ASSERT_EQ(model.images.size(), 2u);
  EXPECT_EQ(model.points.size(), 10u);
  ASSERT_EQ(model.images[0].observations.size(), 10u);
  const CameraModel& pinhole = model.cameras[0].model;
  EXPECT_NEAR(model.images[0].observations[9].px.x(), pinhole.cx + 280 * std::tan(M_PI / 6), 1e-6);
  EXPECT_NEAR(model.images[0].observations[9].px.y(), pinhole.cy, 1e-6);
}

}  // namespace
}  // namespace coslam::exporting::undistort_test
