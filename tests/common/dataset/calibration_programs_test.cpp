// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Calibrations as single programs write them, and lenses for which the nearest known one stands.
#include <gmock/gmock.h>

#include <cmath>

#include "common/base/error.h"
#include "common/dataset/calibration.h"
#include "common/dataset/lens_fit.h"
#include "tests/support/temp_folder.h"

namespace coslam::calibration_programs_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CalibrationOfPrograms : public ::testing::Test {
 protected:
  CameraModel load(const std::string& text, const std::string& file = "calib.yaml", const std::string& camera = "") {
    return load_calibration(folder_.write(file, text).string() + camera);
  }
  std::string error(const std::string& text, const std::string& file = "calib.yaml", const std::string& camera = "") {
    return test::error_of<UserError>([&] { load(text, file, camera); });
  }
  test::TempFolder folder_;
};

std::array<double, 4> projection(const CameraModel& c) { return {c.fx, c.fy, c.cx, c.cy}; }

TEST_F(CalibrationOfPrograms, Kitti) {
  const std::string numbers = ": 7.2e+02 0 6.1e+02 0.5 0 7.1e+02 1.7e+02 0 0 0 1 0\n", size = ": 1.242e+03 3.75e+02\n";
  const std::string raw = "calib_time: 09-Jan-2012 13:57:47\nS_00: 1.392e+03 5.12e+02\nS_rect_00" + size;
  const CameraModel one = load(raw + "P_rect_00" + numbers, "calib_cam_to_cam.txt");
  EXPECT_THAT(projection(one), ElementsAre(720, 710, 610, 170));
  EXPECT_EQ(one.width_px, 1242);
  EXPECT_EQ(one.height_px, 375);
  EXPECT_EQ(one.distortion, DistortionModel::kNone);
  const std::string two = raw + "P_rect_00" + numbers + "S_rect_01" + size + "P_rect_01" + numbers;
  EXPECT_EQ(load(two, "calib.txt", "#P_rect_01"), one);
  EXPECT_THAT(error(two),
              HasSubstr("there are several cameras in it (P_rect_00, P_rect_01): name one, as FILE#CAMERA"));
  EXPECT_THAT(
      error("P0" + numbers + "P1" + numbers, "calib.txt", "#P1"),
      HasSubstr("calib.txt:2: P1: the size of the images is not in it: write `width:`, `height:` and `fx: 720`"));
}

TEST_F(CalibrationOfPrograms, Basalt) {
  const auto text = [](const std::string& lenses, const std::string& sizes = "[480, 360]") {
    return "{\"value0\": {\"intrinsics\": [" + lenses + "], \"resolution\": [" + sizes + "]}}\n";
  };
  const auto lens = [](const std::string& type, const std::string& terms) {
    return "{\"camera_type\": \"" + type + R"(", "intrinsics": {"fx": 347, "fy": 346, "cx": 242, "cy": 178)" + terms +
           "}}";
  };
  const std::string bent = lens(
      "pinhole-radtan8", R"(, "k1": -0.28, "k2": 0.07, "p1": 3e-4, "p2": 2e-4, "k3": 0, "k4": 0, "k5": 0, "k6": 0)");
  const CameraModel radtan = load(text(bent), "calib.json");
  EXPECT_EQ(radtan.width_px, 480);
  EXPECT_EQ(radtan.height_px, 360);
  EXPECT_THAT(projection(radtan), ElementsAre(347, 346, 242, 178));
  EXPECT_THAT(radtan.coefficients, ElementsAre(-0.28, 0.07, 3e-4, 2e-4, 0, 0, 0, 0));
  EXPECT_EQ(load(text(lens("pinhole", ""))).distortion, DistortionModel::kNone);
  EXPECT_EQ(load(text(lens("ds", R"(, "xi": -0.2, "alpha": 0.5)"))).fx, 347 / 0.8);
  EXPECT_EQ(load(text(lens("eucm", R"(, "alpha": 0.5, "beta": 1)"))).distortion, DistortionModel::kEquidistant);
  const std::string fisheye = lens("kb4", R"(, "k1": 0.01, "k2": 0, "k3": 0, "k4": 0)");
  const std::string two = text(bent + ", " + fisheye, "[480, 360], [640, 480]");
  EXPECT_EQ(load(two, "calib.json", "#cam1").distortion, DistortionModel::kEquidistant);
  EXPECT_THAT(error(two), HasSubstr("(cam0, cam1): name one, as FILE#CAMERA"));
  EXPECT_THAT(error(two, "calib.json", "#cam2"), HasSubstr("no camera 'cam2', of these there are: cam0, cam1"));
  EXPECT_THAT(error(two, "calib.json", "#left"), HasSubstr("no camera 'left'"));
  EXPECT_THAT(error(text(lens("fov", R"(, "w": 0.9)"))), HasSubstr("the camera type 'fov' is not supported"));
  EXPECT_THAT(error(text("")), HasSubstr("there is no camera"));
}

TEST_F(CalibrationOfPrograms, MatricesMayBeListsOfRows) {
  const CameraModel camera = load(
      R"({"camera_matrix": [[347, 0, 242], [0, 346, 178], [0, 0, 1]], "dist_coeff": [[-0.28, 0.07, 3e-4, 2e-4, 0]],)"
      R"( "image_width": 480, "image_height": 360})");
  EXPECT_THAT(projection(camera), ElementsAre(347, 346, 242, 178));
  EXPECT_THAT(camera.coefficients, ElementsAre(-0.28, 0.07, 3e-4, 2e-4, 0, 0, 0, 0));
}

TEST_F(CalibrationOfPrograms, Camodocal) {
  const std::string head = "%YAML:1.0\n---\ncamera_name: left\nimage_width: 752\nimage_height: 480\n";
  const CameraModel pinhole =
      load(head +
           "model_type: PINHOLE\ndistortion_parameters: {k1: -0.3, k2: 0.1, p1: 0.01, p2: 0.02}\n"
           "projection_parameters: {fx: 468, fy: 467, cx: 382, cy: 214}\n");
  EXPECT_EQ(pinhole.distortion, DistortionModel::kRadTan);
  EXPECT_THAT(pinhole.coefficients, ElementsAre(-0.3, 0.1, 0.01, 0.02, 0, 0, 0, 0));
  EXPECT_THAT(projection(pinhole), ElementsAre(468, 467, 382, 214));
  const CameraModel fisheye = load(head +
                                   "model_type: KANNALA_BRANDT\nprojection_parameters: {k2: -0.02, k3: 0.01, k4: "
                                   "-0.03, k5: 0.04, mu: 368, mv: 367, u0: 374, v0: 240}\n");
  EXPECT_EQ(fisheye.distortion, DistortionModel::kEquidistant);
  EXPECT_THAT(fisheye.coefficients, ElementsAre(-0.02, 0.01, -0.03, 0.04, 0, 0, 0, 0));
  EXPECT_THAT(projection(fisheye), ElementsAre(368, 367, 374, 240));
  const CameraModel mei = load(head +
                               "model_type: MEI\nmirror_parameters: {xi: 1.0}\ndistortion_parameters: {k1: -0.1, k2: "
                               "0.02, p1: 0.001, p2: 0.002}\nprojection_parameters: {gamma1: 800, gamma2: 801, u0: "
                               "374, v0: 240}\n");
  EXPECT_EQ(mei.distortion, DistortionModel::kOmni);
  EXPECT_THAT(mei.coefficients, ElementsAre(1, -0.1, 0.02, 0.001, 0.002, 0, 0, 0));
  EXPECT_DOUBLE_EQ(mei.fx, 400);
  EXPECT_THAT(error(head + "model_type: SCARAMUZZA\nprojection_parameters: {}\n"), HasSubstr("'SCARAMUZZA' is not"));
}

TEST_F(CalibrationOfPrograms, StellaFlatAndNested) {
  const std::string flat =
      "Camera.model: perspective\nCamera.fx: 1680\nCamera.fy: 1681\nCamera.cx: 1150\nCamera.cy: 646\nCamera.k1: -0.1\n"
      "Camera.k2: 0.2\nCamera.p1: 0.01\nCamera.p2: 0.02\nCamera.k3: 0.03\nCamera.cols: 2300\nCamera.rows: 1293\n";
  const std::string nested =
      "Camera:\n  name: phone\n  model: perspective\n  fx: 1680\n  fy: 1681\n  cx: 1150\n  cy: 646\n  k1: -0.1\n"
      "  k2: 0.2\n  p1: 0.01\n  p2: 0.02\n  k3: 0.03\n  cols: 2300\n  rows: 1293\n  color_order: RGB\n";
  for (const std::string& text : {flat, nested}) {
    const CameraModel c = load(text);
    EXPECT_EQ(c.width_px, 2300);
    EXPECT_EQ(c.height_px, 1293);
    EXPECT_THAT(projection(c), ElementsAre(1680, 1681, 1150, 646));
    EXPECT_THAT(c.coefficients, ElementsAre(-0.1, 0.2, 0.01, 0.02, 0.03, 0, 0, 0));
  }
  const std::string fisheye =
      "Camera.model: fisheye\nCamera.fx: 400\nCamera.fy: 400\nCamera.cx: 320\nCamera.cy: 240\nCamera.k1: 0.1\n"
      "Camera.k2: 0.2\nCamera.k3: 0.3\nCamera.k4: 0.4\nCamera.cols: 640\nCamera.rows: 480\n";
  EXPECT_EQ(load(fisheye).distortion, DistortionModel::kEquidistant);
  EXPECT_THAT(error(fisheye + "Camera.p1: 0.01\n"), HasSubstr("is no term of the lens 'fisheye'"));
  EXPECT_THAT(error("Camera.model: equirectangular\n" + fisheye.substr(fisheye.find('\n') + 1)),
              HasSubstr("'equirectangular' is not supported"));
}

TEST_F(CalibrationOfPrograms, Maplab) {
  const auto camera = [](const std::string& name, int fx, const std::string& distortion) {
    return "- camera:\n    label: " + name + "\n    image_height: 480\n    image_width: 752\n    type: pinhole\n" +
           "    intrinsics: {cols: 1, rows: 4, data: [" + std::to_string(fx) + ", 457, 367, 248]}\n" +
           "    distortion: " + distortion + "\n";
  };
  const std::string radtan = "{type: radial-tangential, parameters: {data: [-0.28, 0.07, 0.0001, 0.00002]}}";
  const std::string one = "label: rig\ncameras:\n" + camera("cam0", 458, radtan);
  const CameraModel c = load(one);
  EXPECT_EQ(c.distortion, DistortionModel::kRadTan);
  EXPECT_THAT(projection(c), ElementsAre(458, 457, 367, 248));
  const std::string two = one + camera("cam1", 400, "{type: none}");
  EXPECT_THAT(error(two), HasSubstr("several cameras in it (cam0, cam1)"));
  EXPECT_EQ(load(two, "rig.yaml", "#cam1").fx, 400);
  EXPECT_THAT(error(two, "rig.yaml", "#cam2"), HasSubstr("there is no camera 'cam2', of these there are: cam0, cam1"));
}

TEST_F(CalibrationOfPrograms, KimeraLeavesOutWhatTheSensorIs) {
  const CameraModel c = load(
      "camera_id: left_cam\nrate_hz: 30\nresolution: [1920, 1080]\ncamera_model: pinhole\nintrinsics: [1388, 1389, "
      "954, "
      "531]\ndistortion_model: none\ndistortion_coefficients: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]\n");
  EXPECT_EQ(c.distortion, DistortionModel::kNone);
  EXPECT_THAT(projection(c), ElementsAre(1388, 1389, 954, 531));
}

TEST_F(CalibrationOfPrograms, OstOfRos) {
  const std::string text =
      "# oST version 5.0 parameters\n\n\n[image]\n\nwidth\n640\n\nheight\n480\n\n[narrow_stereo]\n\ncamera matrix\n"
      "500.5 0.000000 320.5\n0.000000 501.5 240.5\n0.000000 0.000000 1.000000\n\ndistortion\n-0.3 0.1 0.01 0.02 "
      "0.000000\n\nrectification\n1 0 0\n0 1 0\n0 0 1\n";
  const CameraModel c = load(text, "ost.txt");
  EXPECT_EQ(c.width_px, 640);
  EXPECT_THAT(projection(c), ElementsAre(500.5, 501.5, 320.5, 240.5));
  EXPECT_THAT(c.coefficients, ElementsAre(-0.3, 0.1, 0.01, 0.02, 0, 0, 0, 0));
  EXPECT_THAT(error(text.substr(0, text.find("0.000000 501.5")), "ost.txt"), HasSubstr("ost.txt: of 'camera matrix'"));
}

TEST_F(CalibrationOfPrograms, Dso) {
  const CameraModel radtan =
      load("RadTan 458.5 457.5 367 248 -0.28 0.07 0.0002 0.00002\n752 480\ncrop\n640 480\n", "camera.txt");
  EXPECT_EQ(radtan.distortion, DistortionModel::kRadTan);
  EXPECT_THAT(projection(radtan), ElementsAre(458.5, 457.5, 367, 248));
  const CameraModel shares = load("Pinhole 0.5 0.6 0.4 0.45 0\n1000 500\ncrop\n640 480\n", "camera.txt");
  EXPECT_THAT(projection(shares), ElementsAre(500, 300, 399.5, 224.5));
  const CameraModel fov =
      load("0.349153 0.436593 0.493140 0.499021 0.933271\n1280 1024\ncrop\n640 480\n", "camera.txt");
  EXPECT_EQ(fov.distortion, DistortionModel::kEquidistant);
  EXPECT_EQ(fov.width_px, 1280);
  EXPECT_THAT(error("RadTan 1 1 1 1 0.1\n752 480\n", "camera.txt"), HasSubstr("the lens 'RadTan' with 1 terms"));
}

TEST_F(CalibrationOfPrograms, ColmapsFisheyes) {
  const CameraModel simple = load("1 SIMPLE_RADIAL_FISHEYE 752 480 458 376.5 240.5 0.01\n", "cameras.txt");
  EXPECT_EQ(simple.distortion, DistortionModel::kEquidistant);
  EXPECT_THAT(projection(simple), ElementsAre(458, 458, 376, 240));
  EXPECT_EQ(simple.coefficients[0], 0.01);
  EXPECT_EQ(load("1 RADIAL_FISHEYE 752 480 458 376.5 240.5 0.01 0.02\n", "cameras.txt").coefficients[1], 0.02);
  const CameraModel prism =
      load("1 THIN_PRISM_FISHEYE 752 480 458 457 367.5 248.5 0.1 0.2 0 0 0.3 0.4 0 0\n", "cameras.txt");
  EXPECT_THAT(prism.coefficients, ElementsAre(0.1, 0.2, 0.3, 0.4, 0, 0, 0, 0));
  EXPECT_EQ(load("1 FOV 752 480 458 457 367.5 248.5 0.9\n", "cameras.txt").distortion, DistortionModel::kEquidistant);
  EXPECT_THAT(error("1 FOV 752 480 458 457 367.5 248.5\n", "cameras.txt"), HasSubstr("number of parameters"));
}

TEST_F(CalibrationOfPrograms, ACameraIsNamedOnlyWhereThereMayBeSeveral) {
  EXPECT_THAT(error("width: 640\nheight: 480\nfx: 1\nfy: 1\ncx: 1\ncy: 1\n", "calib.yaml", "#cam1"),
              HasSubstr("of this form there is one camera in a file: leave out #cam1"));
}

TEST_F(CalibrationOfPrograms, XmlOfOpenCv) {
  const std::string head =
                        "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>640</image_width>\n"
                        "<image_height>480</image_height>\n<camera_name>\"left\"</camera_name>\n",
                    matrix =
                        "<camera_matrix type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols><dt>d</dt>"
                        "<data>500. 0. 320. 0. 501. 240. 0. 0. 1.</data></camera_matrix>\n",
                    bent =
                        "<distortion_coefficients type_id=\"opencv-matrix\"><rows>1</rows><cols>5</cols><dt>d</dt>"
                        "<data>-1.0e-01 0.02 0.003 0. 0.</data></distortion_coefficients>\n",
                    end = "</opencv_storage>\n";
  const CameraModel camera = load(head + matrix + bent + end, "calib.xml");
  EXPECT_EQ(camera.width_px, 640);
  EXPECT_EQ(camera.fy, 501);
  EXPECT_EQ(camera.cx, 320);
  EXPECT_THAT(camera.coefficients, ElementsAre(-0.1, 0.02, 0.003, 0, 0, 0, 0, 0));
  EXPECT_THAT(error(head + bent + end, "calib.xml"), HasSubstr("camera_matrix"));
  std::string huge = matrix;
  huge.replace(huge.find("<cols>3"), 7, "<cols>1073741824");
  EXPECT_THAT(error(head + huge + bent + end, "calib.xml"), HasSubstr("camera_matrix"));
  EXPECT_THAT(error("<?xml version=\"1.0\"?>\n<opencv_storage></opencv_storage>\n", "calib.xml"),
              HasSubstr("there is no camera in it"));
  EXPECT_THAT(error("<?xml version=\"1.0\"?>\n<opencv_storage><a>", "calib.xml"), HasSubstr("calib.xml"));
}

TEST_F(CalibrationOfPrograms, APartOfTheSensor) {
  const auto info = [](const std::string& rest) {
    return "height: 400\nwidth: 640\ndistortion_model: plumb_bob\nD: [0.1, 0, 0, 0, 0]\nK: [404, 0, 631, 0, 405, "
           "375.5, "
           "0, 0, 1]\n" +
           rest;
  };
  const CameraModel part =
      load(info("binning_x: 1\nbinning_y: 1\nroi: {x_offset: 320, y_offset: 200, height: 400, width: 640}\n"));
  EXPECT_THAT(projection(part), ElementsAre(404, 405, 311, 175.5));
  EXPECT_EQ(part.width_px, 640);
  const CameraModel whole = load(info("roi: {x_offset: 0, y_offset: 0, height: 400, width: 640}\n"));
  EXPECT_THAT(projection(whole), ElementsAre(404, 405, 631, 375.5));
  const CameraModel none = load(info("binning_x: 0\nroi: {x_offset: 0, y_offset: 0, height: 0, width: 0}\n"));
  EXPECT_EQ(none, whole);
  const CameraModel binned = load(info("binning_x: 2\nbinning_y: 2\n"));
  EXPECT_EQ(binned.width_px, 320);
  EXPECT_EQ(binned.height_px, 200);
  EXPECT_THAT(projection(binned), ElementsAre(202, 202.5, 315.25, 187.5));
}

// Where a lens sees what is at an angle in a direction of the image, against its own formula.
double worst_px(const CameraModel& fitted, const CameraModel& of, const RadiusOfAngle& radius) {
  double worst = 0;
  for (double angle = 0.02; angle < 1.5; angle += 0.02) {
    for (double direction = 0; direction < 6.2; direction += 0.4) {
      const Eigen::Vector2d d(std::cos(direction), std::sin(direction));
      const Eigen::Vector2d truth = of.pixel_from_normalized(radius(angle) * d);
      if (!of.contains_raw(truth)) continue;
      const Eigen::Vector2d n = fitted.distort_normalized(std::tan(angle) * d);
      worst = std::max(worst, (fitted.pixel_from_normalized(n) - truth).norm());
    }
  }
  return worst;
}

TEST(LensFit, FieldOfViewAndExtendedUnifiedLensesAreMetToATenthOfAPixel) {
  CameraModel camera;
  camera.width_px = 752, camera.height_px = 480;
  camera.fx = 460, camera.fy = 455, camera.cx = 372, camera.cy = 237;
  for (const RadiusOfAngle& lens : {field_of_view_lens(0.92), extended_unified_lens(0.62, 1.08)}) {
    const FittedLens fit = fit_equidistant(camera, lens);
    EXPECT_LT(fit.miss_px, 0.1);
    EXPECT_LT(worst_px(fit.camera, camera, lens), 2 * fit.miss_px + 1e-6);
  }
  const FittedLens wide = fit_equidistant(camera, [](double angle) { return 2 * std::tan(angle / 2); });
  EXPECT_LT(wide.miss_px, 0.1) << "stereographic";
  EXPECT_THAT(fit_said("FOV", wide), HasSubstr("the lens 'FOV' is taken as the nearest equidistant one, which is "));
}

}  // namespace
}  // namespace coslam::calibration_programs_test
