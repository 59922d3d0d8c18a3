// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Calibrations of every dialect, and truth of poses: the first octet says which kind of file it is. What was read can
// be written for every other program.
#include <unistd.h>

#include <array>
#include <string>

#include "common/dataset/calibration.h"
#include "deploy/coslam/calibrate/dialects.h"
#include "deploy/coslam/eval/truth.h"
#include "tests/fuzz/fuzzer.h"

namespace coslam {
namespace {

enum Kind : std::uint8_t { kYaml, kXml, kOst, kColmap, kDso, kTum, kKitti, kEuroc, kKinds };
constexpr std::array<const char*, kKinds> kNames = {"calib.yaml", "calib.xml", "ost.txt",   "cameras.txt",
                                                    "camera.txt", "truth.tum", "poses.txt", "data.csv"};

// Files are told by their names, too.
std::filesystem::path named(const char* name, const std::filesystem::path& file) {
  static const std::filesystem::path folder = [] {
    const auto made = std::filesystem::temp_directory_path() / ("coslam-fuzz-" + std::to_string(getpid()));
    std::filesystem::create_directories(made);
    return made;
  }();
  std::error_code there_already;
  std::filesystem::create_symlink(file, folder / name, there_already);
  return folder / name;
}

}  // namespace

void fuzz::try_octets(Octets octets) {
  if (octets.empty()) return;
  const int kind = octets[0] % kKinds;
  const std::filesystem::path file = named(kNames[static_cast<std::size_t>(kind)], file_of(text_of(octets.subspan(1))));
  if (kind >= kTum) {
    eval::load_truth({.name = "a", .source = "none", .truth = file}, 20);
    return;
  }
  const CameraModel camera = load_calibration(octets[0] >= 128 ? file.string() + "#cam1" : file.string());
  for (const std::string& dialect : calibration_dialects()) written_calibration(camera, dialect);
}

void fuzz::write_seeds(const WriteSeed& write_seed) {
  const auto write = [&](const std::string& name, int kind, const std::string& text) {
    write_seed(name, static_cast<char>(kind) + text);
  };
  const std::string numbers = "fx: 458\nfy: 457\ncx: 367\ncy: 248\n", size = "width: 752\nheight: 480\n";
  write("plain", kYaml, size + numbers + "distortion_model: radtan\ndistortion: [-0.28, 0.07, 0.0001, 0.00002]\n");
  write("omni", kYaml, size + numbers + "distortion_model: omni\ndistortion: [1.1, -0.1, 0.02, 0.001, 0.002]\n");
  write("opencv", kYaml,
        "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n"
        "   dt: d\n   data: [ 500., 0., 320., 0., 501., 240., 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n"
        "   rows: 1\n   cols: 5\n   dt: d\n   data: [ -0.1, 0.02, 0.003, 0., 0. ]\n");
  write(
      "ros", kYaml,
      "height: 400\nwidth: 640\ndistortion_model: plumb_bob\nD: [0.1, 0, 0, 0, 0]\nK: [404, 0, 631, 0, 405, 375.5, 0, "
      "0, 1]\nbinning_x: 2\nbinning_y: 2\nroi: {x_offset: 320, y_offset: 200, height: 400, width: 640}\n");
  const std::string kalibr = "  resolution: [752, 480]\n  intrinsics: [458, 457, 367, 248]\n";
  write("kalibr", 128 + kYaml,
        "cam0:\n  camera_model: pinhole\n  distortion_model: equidistant\n  distortion_coeffs: [0.1, 0.2, 0, 0]\n" +
            kalibr + "cam1:\n  camera_model: pinhole\n  distortion_model: fov\n  distortion_coeffs: [0.9]\n" + kalibr);
  write("kalibr_ds", kYaml,
        "cam0:\n  camera_model: ds\n  distortion_model: none\n  distortion_coeffs: []\n  resolution: [752, 480]\n"
        "  intrinsics: [-0.2, 0.6, 300, 301, 367, 248]\n");
  write("orb_slam", kYaml,
        "Camera.type: \"PinHole\"\nCamera1.fx: 458\nCamera1.fy: 457\nCamera1.cx: 367\nCamera1.cy: 248\nCamera1.k1: "
        "-0.28\nCamera.width: 752\nCamera.height: 480\n");
  write("stella", kYaml,
        "Camera:\n  model: fisheye\n  fx: 400\n  fy: 400\n  cx: 320\n  cy: 240\n  k1: 0.1\n  cols: 640\n  rows: 480\n");
  write("euroc", kYaml,
        "sensor_type: camera\nresolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [458, 457, 367, 248]\n"
        "distortion_model: radial-tangential\ndistortion_coefficients: [-0.28, 0.07, 0.0001, 0.00002]\n");
  write("camodocal", kYaml,
        "%YAML:1.0\n---\nmodel_type: MEI\ncamera_name: left\nimage_width: 752\nimage_height: 480\nmirror_parameters: "
        "{xi: 1.0}\ndistortion_parameters: {k1: -0.1, k2: 0.02, p1: 0.001, p2: 0.002}\nprojection_parameters: {gamma1: "
        "800, gamma2: 801, u0: 374, v0: 240}\n");
  write("maplab", kYaml,
        "label: rig\ncameras:\n- camera:\n    label: cam1\n    image_height: 480\n    image_width: 752\n    type: "
        "pinhole\n    intrinsics: {cols: 1, rows: 4, data: [458, 457, 367, 248]}\n    distortion: {type: "
        "radial-tangential, parameters: {data: [-0.28, 0.07, 0.0001, 0.00002]}}\n");
  write(
      "xml", kXml,
      "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>640</image_width>\n<image_height>480</image_height>\n"
      "<camera_matrix type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols><dt>d</dt><data>500. 0. 320. 0. 501. 240. "
      "0. 0. 1.</data></camera_matrix>\n<distortion_coefficients type_id=\"opencv-matrix\"><rows>1</rows><cols>5"
      "</cols><dt>d</dt><data>-1.0e-01 0.02 0.003 0. 0.</data></distortion_coefficients>\n</opencv_storage>\n");
  write("ost", kOst,
        "# oST version 5.0 parameters\n\n\n[image]\n\nwidth\n640\n\nheight\n480\n\n[narrow_stereo]\n\ncamera matrix\n"
        "500.5 0 320.5\n0 501.5 240.5\n0 0 1\n\ndistortion\n-0.3 0.1 0.01 0.02 0\n\nrectification\n1 0 0\n0 1 0\n");
  write("colmap", kColmap, "# ID MODEL\n1 THIN_PRISM_FISHEYE 752 480 458 457 367.5 248.5 0.1 0.2 0 0 0.3 0.4 0 0\n");
  write("colmap_fov", kColmap, "1 FOV 752 480 458 457 367.5 248.5 0.9\n");
  write("dso", kDso, "RadTan 458.5 457.5 367 248 -0.28 0.07 0.0002 0.00002\n752 480\ncrop\n640 480\n");
  write("dso_fov", kDso, "0.349153 0.436593 0.493140 0.499021 0.933271\n1280 1024\ncrop\n640 480\n");
  write("tum", kTum, "# t x y z qx qy qz qw\n0.5 1 2 3 0 0 0 1\n0.6 1 2 3 0 0 0 1\n");
  write("kitti", kKitti, "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0.5\n");
  write("truth_euroc", kEuroc,
        "#timestamp, p_x\n1403636580838555648,1,2,3,1,0,0,0\n1403636580843555328,1,2,3,1,0,0,0\n");
}

}  // namespace coslam
