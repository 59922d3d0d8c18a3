// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/calibration_doubt.h"

#include <gmock/gmock.h>

namespace coslam::calibration_doubt_test {
namespace {

using testing::HasSubstr;

constexpr auto kNone = DistortionModel::kNone, kRadTan = DistortionModel::kRadTan;

// Of a car's, a drone's, a hand-held and a fisheye camera; of an anamorphic one; of one whose image was cut out.
const CameraModel kKitti{1392, 512, 984.24, 980.81, 690, 233.2, kRadTan, {-0.373, 0.204, 0.0022, 0.0014, -0.0723}};
const CameraModel kEuroc{752, 480, 458.654, 457.296, 367.215, 248.375, kRadTan, {-0.283, 0.074, 0.0002, 0.00002}};
const CameraModel kTum{640, 480, 517.3, 516.5, 318.6, 255.3, kRadTan, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}};
const CameraModel kFisheye{512, 512, 191, 191, 254.9, 256.9, DistortionModel::kEquidistant, {0.0035, 0.0007, -0.002}};

CameraModel pinhole(double fx, double fy, double cx, double cy) { return {752, 480, fx, fy, cx, cy, kNone, {}}; }

CameraModel bent(const std::array<double, 8>& coefficients) {
  CameraModel out = kEuroc;
  out.coefficients = coefficients;
  return out;
}

TEST(CalibrationDoubt, ThereIsNoneOfUsualCameras) {
  for (const CameraModel& camera : {kKitti, kEuroc, kTum, kFisheye, pinhole(120, 120, 375, 240)}) {
    EXPECT_EQ(doubt_of(camera, false).text, "") << camera.fx;
    EXPECT_EQ(unit_problem_of(camera), "");
  }
}

void expect_doubt(const CameraModel& camera, bool hopeless, const std::string& text) {
  const CalibrationDoubt doubt = doubt_of(camera, false);
  EXPECT_THAT(doubt.text, HasSubstr(text));
  EXPECT_EQ(doubt.hopeless, hopeless) << doubt.text;
}

TEST(CalibrationDoubt, NumbersInAnotherOrder) {
  expect_doubt(pinhole(458.6, 367.2, 457.3, 248.4), true, "are 458.6 367.2 457.3 248.4: are they fx cx fy cy?");
  expect_doubt(pinhole(367.2, 248.4, 458.6, 457.3), true, "are they cx cy fx fy?");
}

TEST(CalibrationDoubt, FocalLengths) {
  expect_doubt(pinhole(458.6, 611.5, 375, 240), false, "fx 458.6 and fy 611.5 px, are far apart");  // anamorphic
  expect_doubt(pinhole(458.6, 45.7, 375, 240), true, "fx 458.6 and fy 45.7 px, are far apart: a slip");
  expect_doubt(pinhole(78.6, 78.6, 375, 240), true, "no focal length as short as 78.6 px of 752: is it an angle?");
}

TEST(CalibrationDoubt, PrincipalPoint) {
  expect_doubt(pinhole(458, 458, 375, 380), false, "(375.0, 380.0), is far from the middle of 752x480 pixels");
  expect_doubt(pinhole(458, 458, 734, 240), true, "is it for images of another size?");
  expect_doubt(pinhole(229, 229, 183, 124), true, "is it for images of about 367x249?");
  EXPECT_EQ(doubt_of(pinhole(458, 458, 734, 240), true).text, "") << "a region of interest has it anywhere";
}

TEST(CalibrationDoubt, DistortionThatIsInAnotherOrder) {
  expect_doubt(bent({-0.283, 0.074, 0.0002, 0.00002, -3.5}), true, "fold the picture from 207 px");
  expect_doubt(bent({-0.283, 0.0002, 0.00002, 0.074}), true, "a tangential coefficient of 0.074");
  expect_doubt(bent({-0.283, 0.074, 0.02, 0.0002, 0.00002}), true, "in the order k1 k2 k3 p1 p2");
  expect_doubt(bent({-0.283, 0.074, 0.0002, 0.02}), false, "a tangential coefficient of 0.02 is more than most");
  EXPECT_EQ(doubt_of(bent({-0.283, 0.074, 0, 0, -3.5}), false).focal_px, kEuroc.focal_px());
}

TEST(CalibrationDoubt, RadtanThatIsCalledEquidistant) {
  CameraModel named = kEuroc;
  named.distortion = DistortionModel::kEquidistant;
  expect_doubt(named, true, "are they radtan's k1 k2 p1 p2?");
  named.coefficients = {-1.0 / 6, 1.0 / 120};  // orthographic
  EXPECT_EQ(doubt_of(named, false).text, "");
}

TEST(CalibrationDoubt, FocalLengthsThatAreNotInPixelsAreAProblem) {
  EXPECT_EQ(unit_problem_of(pinhole(2.75, 2.74, 2.2, 1.49)),
            "no lens has a focal length of 2.75 pixels for images of 752x480: is it in millimetres, or a share of the "
            "size?");
  EXPECT_THAT(unit_problem_of(pinhole(4e4, 4e4, 375, 240)), HasSubstr("no lens has a focal length of 4e+04 pixels"));
  EXPECT_EQ(unit_problem_of(pinhole(458.6, 45.7, 375, 240)), "");
}

}  // namespace
}  // namespace coslam::calibration_doubt_test
