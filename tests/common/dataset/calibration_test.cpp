// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/calibration.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/common/dataset/calibration_files.h"
#include "tests/support/temp_folder.h"

namespace coslam::calibration_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Calibration : public test::CalibrationFiles {};

void expect_camera(const CameraModel& c, DistortionModel distortion) {
  EXPECT_EQ(c.width_px, 752);
  EXPECT_EQ(c.height_px, 480);
  EXPECT_DOUBLE_EQ(c.fx, 458.5);
  EXPECT_DOUBLE_EQ(c.fy, 457.5);
  EXPECT_DOUBLE_EQ(c.cx, 367.0);
  EXPECT_DOUBLE_EQ(c.cy, 248.0);
  EXPECT_EQ(c.distortion, distortion);
}

TEST_F(Calibration, Plain) {
  const std::string size = "width: 752\nheight: 480\nfx: 458.5\nfy: 457.5\ncx: 367\ncy: 248\n";
  expect_camera(load(size), DistortionModel::kNone);
  expect_camera(load(size + "distortion_model: none\ndistortion: []\n"), DistortionModel::kNone);
  expect_camera(load(size + "distortion_model: none\n"), DistortionModel::kNone);
  expect_camera(load(size + "distortion_model: radtan\ndistortion: [0, 0, 0, 0]\n"), DistortionModel::kNone);
  const CameraModel c = load(size + "distortion_model: radtan\ndistortion: [-0.3, 0.1, 1e-4, 2e-5]\n");
  expect_camera(c, DistortionModel::kRadTan);
  EXPECT_THAT(c.coefficients, ElementsAre(-0.3, 0.1, 1e-4, 2e-5, 0, 0, 0, 0));
  expect_camera(load(size + "distortion_model: equidistant\ndistortion: [0, 0, 0, 0]\n"),
                DistortionModel::kEquidistant);

  EXPECT_THAT(error(size + "distortion: [0.1, 0, 0, 0]\n"), HasSubstr("'distortion_model' is missing"));
  EXPECT_THAT(error(size + "distortion_model: radtan\n"), HasSubstr("'distortion' is missing"));
  EXPECT_THAT(error(size + "distortion_model: radtan\ndistortion: [0.1, 0]\n"), HasSubstr("4, 5 or 8 are expected"));
  EXPECT_THAT(error(size + "distortion_model: fov\ndistortion: [0.1]\n"),
              HasSubstr("calib.yaml:7: distortion_model: the distortion model 'fov' is not supported"));
  EXPECT_THAT(error(size + "distorsion_model: radtan\n"), HasSubstr("did you mean 'distortion_model'?"));
  EXPECT_THAT(error("width: 752\nheight: 480\nfx: 458.5\nfy: 457.5\ncx: 367\n"), HasSubstr("the key 'cy' is missing"));
  EXPECT_THAT(error("width: 752\nheight: 480\nfx: 0\nfy: 457.5\ncx: 367\ncy: 248\n"),
              HasSubstr("calib.yaml: the focal lengths must be positive"));
  EXPECT_THAT(error("width: 640\nheight: 480\nfx: 458\nfy: 457.5\ncx: 1367\ncy: 248\n"),
              HasSubstr("the principal point lies far outside the image"));
}

TEST_F(Calibration, OpenCv) {
  const std::string head = R"(%YAML:1.0
---
calibration_time: "Mon 01 Jan 2024"
image_width: 752
image_height: 480
flags: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 4.585e+02, 0., 367., 0., 457.5, 248., 0., 0., 1. ]
)";
  const auto distortion = [](const std::string& data) {
    return "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [" + data + "]\n";
  };
  const CameraModel c = load(head + distortion("-.3, .1, 1e-4, 2e-5, 0.01"));
  expect_camera(c, DistortionModel::kRadTan);
  EXPECT_THAT(c.coefficients, ElementsAre(-0.3, 0.1, 1e-4, 2e-5, 0.01, 0, 0, 0));
  expect_camera(load(head + distortion("1,2,3,4,5,6,7,8,0,0,0,0")), DistortionModel::kRadTan);
  expect_camera(load(head + "fisheye_model: 1\n" + distortion("0.1,0,0,0")), DistortionModel::kEquidistant);
  expect_camera(load(head + distortion("0.1,0.2,0,0,0,0,0,0,0.001,0,0,0")), DistortionModel::kRadTan);
  EXPECT_THAT(error(head + distortion("1,2,3,4,5,6,7,8,9,0,0,0,0.1,0")), HasSubstr("tilted sensor"));
  EXPECT_THAT(error(head), HasSubstr("'distortion_coefficients' is missing"));
}

TEST_F(Calibration, OrbSlam) {
  const std::string head =
      "%YAML:1.0\n\n# camera\nCamera.fx: 458.5\nCamera.fy: 457.5\nCamera.cx: 367.0\nCamera.cy: 248.0\n";
  const std::string size = "Camera.width: 752\nCamera.height: 480\n";
  const CameraModel c = load(head + size + "Camera.k1: -0.3\nCamera.k2: 0.1\nCamera.p1: 0.01\nCamera.p2: 0\n");
  expect_camera(c, DistortionModel::kRadTan);
  EXPECT_THAT(c.coefficients, ElementsAre(-0.3, 0.1, 0.01, 0, 0, 0, 0, 0));
  expect_camera(load("Camera.type: \"KannalaBrandt8\"\nCamera1.fx: 458.5\nCamera1.fy: 457.5\nCamera1.cx: 367.0\n"
                     "Camera1.cy: 248.0\nCamera1.k1: 0.01\nCamera1.k2: 0\nCamera1.k3: 0\nCamera1.k4: 0\n" +
                     size),
                DistortionModel::kEquidistant);
  EXPECT_THAT(error(head), HasSubstr("the key 'Camera.width' is missing"));
  EXPECT_THAT(error("Camera.type: Omni\n" + head.substr(10) + size), HasSubstr("'Omni' is not supported"));
}

TEST_F(Calibration, RosCameraInfo) {
  const std::string head = R"(image_width: 752
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [458.5, 0, 367, 0, 457.5, 248, 0, 0, 1]
)";
  const auto tail = [](const std::string& model, const std::string& data) {
    return "distortion_model: " + model + "\ndistortion_coefficients: {rows: 1, cols: 5, data: [" + data + "]}\n";
  };
  const CameraModel c = load(head + tail("plumb_bob", "-0.3, 0.1, 0, 0, 0.02"));
  expect_camera(c, DistortionModel::kRadTan);
  EXPECT_EQ(c.coefficients[4], 0.02);
  expect_camera(load(head + tail("rational_polynomial", "1,2,3,4,5,6,7,8")), DistortionModel::kRadTan);
  expect_camera(load(head + tail("equidistant", "0.1,0,0,0")), DistortionModel::kEquidistant);
  expect_camera(load("width: 752\nheight: 480\ndistortion_model: plumb_bob\nd: [0.1, 0, 0, 0, 0]\n"
                     "k: [458.5, 0, 367, 0, 457.5, 248, 0, 0, 1]\n"),
                DistortionModel::kRadTan);
  EXPECT_THAT(error(head + tail("thin_prism", "1,2,3,4")), HasSubstr("'thin_prism' is not supported"));
  EXPECT_THAT(
      error("width: 752\nheight: 480\ndistortion_model: plumb_bob\nd: []\nk: [0, 0, 0, 0, 0, 0, 0, 0, 0]\n"),
      HasSubstr("calib.yaml:5: k: this camera is not calibrated, its matrix is zero: leave the calibration out"));
}

TEST_F(Calibration, IsDoubtedWithTheNameOfItsFile) {
  const auto doubt = [&](const std::string& text) { return read_calibration(folder_.write("calib.yaml", text)).doubt; };
  const std::string size = "width: 752\nheight: 480\nfx: 458.5\nfy: 457.5\n";
  EXPECT_EQ(doubt(size + "cx: 367\ncy: 248\n").text, "");
  EXPECT_THAT(doubt(size + "cx: 734\ncy: 240\n").text, HasSubstr("calib.yaml: its principal point, (734.0, 240.0)"));
  const auto outside = read_calibration(folder_.write("calib.yaml", size + "cx: 767\ncy: 240\n")).doubt;
  EXPECT_TRUE(outside.hopeless);
  EXPECT_THAT(outside.text, HasSubstr("is it for images of another size"));
  EXPECT_THAT(error("width: 752\nheight: 480\nfx: 2.75\nfy: 2.75\ncx: 2.2\ncy: 1.5\n"),
              HasSubstr("calib.yaml: no lens has a focal length of 2.75 pixels"));
  const std::string sensor =
      "width: 752\nheight: 480\ndistortion_model: \"\"\nd: []\nk: [458, 0, 367, 0, 458, 248, 0, 0, 1]\n";
  EXPECT_EQ(doubt(sensor + "roi: {x_offset: 0, y_offset: 0, width: 752, height: 260}\n").text, "");
  EXPECT_EQ(doubt(sensor + "roi: {x_offset: 0, y_offset: 0, width: 752, height: 215}\n").text, "")
      << "the axis below it";
}

TEST_F(Calibration, Kalibr) {
  const auto camera = [](const std::string& name, const std::string& model, const std::string& distortion,
                         const std::string& fx) {
    return name + ":\n  cam_overlaps: [1]\n  camera_model: " + model + "\n  distortion_coeffs: [0.1, 0, 0, 0]\n" +
           "  distortion_model: " + distortion + "\n  intrinsics: [" + fx + ", 457.5, 367, 248]\n" +
           "  resolution: [752, 480]\n  rostopic: /cam/image_raw\n";
  };
  const std::string chain =
      camera("cam0", "pinhole", "radtan", "458.5") + camera("cam1", "pinhole", "equidistant", "400");
  expect_camera(load(chain, "cam0"), DistortionModel::kRadTan);
  expect_camera(load(camera("cam0", "pinhole", "radtan", "458.5")), DistortionModel::kRadTan);
  EXPECT_THAT(error(chain), HasSubstr("several cameras in it (cam0, cam1): name one, as FILE#CAMERA"));
  EXPECT_EQ(load(chain, "cam1").fx, 400);
  EXPECT_EQ(load(chain, "cam1").distortion, DistortionModel::kEquidistant);
  EXPECT_THAT(error(chain, "cam7"), HasSubstr("there is no camera 'cam7', of these there are: cam0, cam1"));
  EXPECT_THAT(error(camera("cam0", "eucm", "radtan", "458.5")), HasSubstr("[alpha, beta, fx, fy, cx, cy]"));
  EXPECT_THAT(error(camera("cam0", "ucm", "radtan", "458.5")), HasSubstr("the camera model 'ucm' is not supported"));
  EXPECT_THAT(error(camera("cam0", "pinhole", "fov", "458.5")), HasSubstr("one number is expected"));
  EXPECT_THAT(error("cam0:\n  camera_model: pinhole\n  distortion_model: fov\n  intrinsics: [458, 457, 367, 248]\n"
                    "  resolution: [752, 480]\n"),
              HasSubstr("the key 'distortion_coeffs' is missing"));
}

TEST_F(Calibration, KalibrSpheres) {
  const auto camera = [](const std::string& model, const std::string& distortion, const std::string& coefficients,
                         const std::string& intrinsics) {
    return "cam0:\n  camera_model: " + model + "\n  distortion_coeffs: [" + coefficients + "]\n" +
           "  distortion_model: " + distortion + "\n  intrinsics: [" + intrinsics + "]\n  resolution: [752, 480]\n";
  };
  const CameraModel ds = load(camera("ds", "none", "", "-0.2, 0.6, 320, 319, 367, 248"));
  EXPECT_EQ(ds.distortion, DistortionModel::kDoubleSphere);
  EXPECT_EQ(ds.coefficients, (std::array<double, 8>{-0.2, 0.6}));
  EXPECT_DOUBLE_EQ(ds.fx, 400);  // in the middle of the image
  EXPECT_EQ(ds.cx, 367);
  const CameraModel omni = load(camera("omni", "radtan", "-0.1, 0.02, 0.001, 0.002", "0.9, 760, 761, 367, 248"));
  EXPECT_EQ(omni.distortion, DistortionModel::kOmni);
  EXPECT_EQ(omni.coefficients, (std::array<double, 8>{0.9, -0.1, 0.02, 0.001, 0.002}));
  EXPECT_DOUBLE_EQ(omni.fx, 400);
  EXPECT_EQ(load(camera("omni", "none", "", "0.9, 760, 761, 367, 248")).coefficients[1], 0);
  EXPECT_THAT(error(camera("ds", "radtan", "1,2,3,4", "-0.2, 0.6, 320, 319, 367, 248")),
              HasSubstr("the distortion model 'radtan' is not supported with the camera model 'ds'"));
  EXPECT_THAT(error(camera("ds", "none", "", "320, 319, 367, 248")), HasSubstr("[xi, alpha, fx, fy, cx, cy]"));
  EXPECT_THAT(error(camera("omni", "none", "", "-1, 760, 761, 367, 248")), HasSubstr("xi of the lens"));
}

TEST_F(Calibration, Euroc) {
  const std::string text = R"(sensor_type: camera
comment: VI-Sensor cam0 (MT9M034)
T_BS:
  cols: 4
  rows: 4
  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
rate_hz: 20
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.5, 457.5, 367.0, 248.0] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
)";
  const CameraModel c = load(text);
  expect_camera(c, DistortionModel::kRadTan);
  EXPECT_EQ(c.coefficients[3], 1.76187114e-05);
  EXPECT_THAT(error("sensor_type: imu\n"), HasSubstr("the sensor is a 'imu', not a camera"));
}

TEST_F(Calibration, Colmap) {
  const std::string head = "# Camera list\n";
  const CameraModel c = load(head + "1 OPENCV 752 480 458.5 457.5 367.5 248.5 -0.3 0.1 0.01 0.02\n");
  expect_camera(c, DistortionModel::kRadTan);  // COLMAP's pixel centres are half a pixel further
  EXPECT_THAT(c.coefficients, ElementsAre(-0.3, 0.1, 0.01, 0.02, 0, 0, 0, 0));
  expect_camera(load("7 PINHOLE 752 480 458.5 457.5 367.5 248.5\n"), DistortionModel::kNone);
  expect_camera(load("7 OPENCV_FISHEYE 752 480 458.5 457.5 367.5 248.5 1 2 3 4\n"), DistortionModel::kEquidistant);
  EXPECT_EQ(load("1 SIMPLE_RADIAL 752 480 400 367.5 248.5 0.1\n").fy, 400);
  EXPECT_EQ(load("1 PINHOLE 640 480 1 1 1 1\n2 PINHOLE 752 480 400 400 367 248\n", "2").width_px, 752);
  EXPECT_THAT(error("1 EQUIRECTANGULAR 752 480 1 2 3 4 5\n"),
              HasSubstr("calib.yaml:1: the camera model 'EQUIRECTANGULAR' is not supported"));
  EXPECT_THAT(error("1 PINHOLE 640 480 1 1 1 1\n2 PINHOLE 752 480 400 400 367 248\n"),
              HasSubstr("several cameras in it (1, 2)"));
  EXPECT_THAT(error("1 OPENCV 752 480 1 2 3 4 5\n"), HasSubstr("number of parameters"));
}

TEST_F(Calibration, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT(error("hello: world\n"), HasSubstr("not a calibration"));
  for (const char* text :
       {"346.8 0 241.8\n0 345.8 178.2\n0 0 1\n", "fc = [ 346.8 ; 345.8 ];\n", "cam0 (/a):\n    b: c: d\n",
        "<?xml version=\"1.0\"?>\n<calibration><f>345.8</f></calibration>\n"}) {
    EXPECT_THAT(error(text), HasSubstr("; write the numbers of another form as width, height, fx")) << text;
  }
  EXPECT_THAT(test::error_of<UserError>([&] { load_calibration(folder_ / "no.yaml"); }), HasSubstr("cannot be read"));
}

TEST_F(Calibration, SavesThePlainForm) {
  std::vector<std::pair<DistortionModel, LensTerms>> lenses = {
      {DistortionModel::kRadTan, {0.1, 0, 0.3, 0, 0, 0, 0.7, 0}},
      {DistortionModel::kEquidistant, {0.1, 1.0 / 3.0, 0.3, 0}},
      {DistortionModel::kOmni, {1, 0.1, 0, 0.3, 0}}};
  for (const DistortionModel model : kDistortionModels) lenses.emplace_back(model, lens_traits(model).typical);
  for (const auto& [model, coefficients] : lenses) {
    save_calibration(folder_ / "saved.yaml", {752, 480, 458.5, 457.5, 367, 248, model, coefficients});
    const CameraModel read = load_calibration(folder_ / "saved.yaml");
    expect_camera(read, model);
    EXPECT_EQ(read.coefficients, coefficients);
  }
}

}  // namespace
}  // namespace coslam::calibration_test
