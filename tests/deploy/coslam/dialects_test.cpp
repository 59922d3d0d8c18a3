// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/calibrate/dialects.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "common/dataset/calibration.h"
#include "tests/support/temp_folder.h"

namespace coslam::dialects_test {
namespace {

CameraModel camera(DistortionModel model, std::array<double, 8> k = {}) {
  CameraModel c{.width_px = 752, .height_px = 480, .fx = 458.654, .fy = 457.296, .cx = 367.215, .cy = 248.375};
  c.distortion = model;
  c.coefficients = k;
  return c;
}

const std::map<std::string, CameraModel> kLenses{
    {"none", camera(DistortionModel::kNone)},
    {"radtan of four", camera(DistortionModel::kRadTan, {-0.283, 0.0739, 0.00019, 1.76e-05})},
    {"radtan of five", camera(DistortionModel::kRadTan, {-0.283, 0.0739, 0.00019, 1.76e-05, -0.004})},
    {"radtan of eight", camera(DistortionModel::kRadTan, {0.4, -0.1, 0.0002, -0.0001, 0.002, 0.7, -0.05, 0.001})},
    {"equidistant", camera(DistortionModel::kEquidistant, {-0.013, 0.02, -0.012, 0.0026})},
    {"double sphere", camera(DistortionModel::kDoubleSphere, {-0.2, 0.56})},
    {"omni", camera(DistortionModel::kOmni, {0.9, -0.2, 0.05, 0.0003, -0.0002})}};

// The largest difference of where the two see a thing in the first one's image.
double apart_px(const CameraModel& a, const CameraModel& b) {
  double most = 0;
  for (int x = 0; x < a.width_px; x += 47) {
    for (int y = 0; y < a.height_px; y += 43) {
      const auto undistorted = a.undistorted_from_raw({x, y});
      if (!undistorted) continue;
      const Eigen::Vector2d n = a.normalized_from_pixel(*undistorted);
      most = std::max(most, (b.pixel_from_normalized(b.distort_normalized(n)) - Eigen::Vector2d(x, y)).norm());
    }
  }
  return most;
}

class Dialects : public testing::TestWithParam<std::string> {
 protected:
  CameraModel read(const std::string& text) {
    const char* name = GetParam() == "colmap" ? "cameras.txt" : "cam.yaml";
    folder_.write(name, text);
    return load_calibration(folder_ / name);
  }
  const test::TempFolder folder_;
};

TEST_P(Dialects, EveryLensModelIsWrittenExactlyOrAsTheNearest) {
  for (const DistortionModel model : kDistortionModels) {
    const CameraModel lens = camera(model, lens_traits(model).typical);
    const WrittenCalibration written = written_calibration(lens, GetParam());
    EXPECT_LE(apart_px(lens, read(written.text)), written.miss_px + 0.02) << lens_traits(model).name();
  }
}

TEST_P(Dialects, WhatIsWrittenIsReadAsTheSameCamera) {
  for (const auto& [name, lens] : kLenses) {
    const WrittenCalibration written = written_calibration(lens, GetParam());
    const CameraModel got = read(written.text);
    EXPECT_EQ(got.width_px, lens.width_px);
    EXPECT_LT(apart_px(written.camera, got), 1e-6) << name << "\n" << written.text;
    EXPECT_LE(apart_px(lens, got), written.miss_px + 0.02) << name << " is not farther off than it says";
    EXPECT_LT(written.miss_px, 1.5) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Dialects, testing::ValuesIn(calibration_dialects()));

TEST(NearestCamera, FindsALensOfItsOwnModelExactly) {
  const CameraModel& lens = kLenses.at("radtan of five");
  const NearestCamera nearest = nearest_camera(lens, DistortionModel::kRadTan, 5);
  EXPECT_LT(nearest.miss_px, 1e-4);
  EXPECT_NEAR(nearest.camera.fx, lens.fx, 1e-3);
}

TEST(WrittenCalibration, SaysWhichLensesHaveNoExactForm) {
  EXPECT_EQ(written_calibration(kLenses.at("omni"), "kalibr").miss_px, 0);
  EXPECT_GT(written_calibration(kLenses.at("omni"), "opencv").miss_px, 0);
  EXPECT_EQ(written_calibration(kLenses.at("radtan of five"), "ros").miss_px, 0);
  EXPECT_GT(written_calibration(kLenses.at("radtan of five"), "kalibr").miss_px, 0) << "Kalibr has four";
}

}  // namespace
}  // namespace coslam::dialects_test
