// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/system/small_scene.h"

#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/base/text.h"
#include "common/dataset/calibration.h"
#include "common/dataset/trajectory.h"

namespace coslam::test {
namespace {

constexpr int kImages = 30;  // different ones of each camera
constexpr int kTexture = 1024;
constexpr double kTexels_per_m = 110;

// A rectangle across the view, nearest first.
struct Panel {
  double z, left, right, top, bottom;
};
constexpr std::array<Panel, 5> kPanels = {{{2.0, -1.0, -0.5, -0.1, 0.6},
                                           {2.3, 0.4, 1.0, -0.8, 0.0},
                                           {2.7, -0.4, 0.3, 0.2, 0.9},
                                           {3.1, -1.3, -0.3, -1.1, -0.3},
                                           {3.8, -1e3, 1e3, -1e3, 1e3}}};

// Grey noise with detail of several sizes.
cv::Mat make_texture() {
  cv::RNG random(7);
  cv::Mat texture(kTexture, kTexture, CV_32F, cv::Scalar(0));
  for (const double sigma : {1.2, 3.0, 8.0}) {
    cv::Mat noise(texture.size(), CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0, 45 * sigma);
    cv::GaussianBlur(noise, noise, {}, sigma, sigma);
    texture += noise;
  }
  texture = texture + 128;
  return texture;
}

Rigid3 pose_of(int camera, int image) {
  const double step = image;
  const Eigen::Vector3d center(SmallScene::kBaseline_m * (camera - 0.5) - 0.15 + 0.012 * step,
                               0.05 * std::sin(0.2 * step + camera), 0.01 * step);
  const Eigen::Quaterniond cam_from_world(Eigen::AngleAxisd(0.05 * std::sin(0.15 * step), Eigen::Vector3d::UnitY()));
  return {cam_from_world, -(cam_from_world * center)};
}

cv::Mat render(const CameraModel& camera, const cv::Mat& texture, const Rigid3& cam_from_world) {
  const Eigen::Vector3d center = cam_from_world.center();
  const Eigen::Matrix3d world_from_cam = cam_from_world.rotation.conjugate().toRotationMatrix();
  cv::Mat map_x(camera.height_px, camera.width_px, CV_32F), map_y = map_x.clone();
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const Eigen::Vector2d px = camera.undistorted_from_raw({u, v}).value();
      const Eigen::Vector3d ray = world_from_cam * camera.normalized_from_pixel(px).homogeneous();
      for (const Panel& panel : kPanels) {
        const Eigen::Vector3d hit = center + (panel.z - center.z()) / ray.z() * ray;
        if (hit.x() < panel.left || hit.x() > panel.right || hit.y() < panel.top || hit.y() > panel.bottom) continue;
        map_x.at<float>(v, u) = static_cast<float>(kTexture / 2 + kTexels_per_m * hit.x() + 97 * panel.z);
        map_y.at<float>(v, u) = static_cast<float>(kTexture / 2 + kTexels_per_m * hit.y());
        break;
      }
    }
  }
  cv::Mat seen;
  cv::remap(texture, seen, map_x, map_y, cv::INTER_LINEAR, cv::BORDER_WRAP);
  seen.convertTo(seen, CV_8U);
  return seen;
}

// Back and forth, the ends not twice.
int image_of(int frame) {
  const int turn = frame % (2 * kImages - 2);
  return turn < kImages ? turn : 2 * kImages - 2 - turn;
}

}  // namespace

SmallScene::SmallScene(int cameras, int frames, DistortionModel lens, const std::array<double, 8>& coefficients) {
  const CameraModel camera{320, 240, 280, 280, 160, 120, lens, coefficients};
  const cv::Mat texture = make_texture();
  save_calibration(calibration(), camera);
  std::string yaml = "name: small\nrate_hz: 30\nscale: {baseline_m: " + format_double(kBaseline_m) + "}\nagents:\n";
  for (int c = 0; c < cameras; ++c) {
    std::filesystem::create_directory(folder_ / name(c));
    for (int i = 0; i < std::min(frames, kImages); ++i)
      cv::imwrite(image(c, i), render(camera, texture, pose_of(c, i)));
    std::string list = "t_s,file\n";
    Trajectory truth;
    for (int f = 0; f < frames; ++f) {
      list += std::to_string(f / kRate_hz) + "," + image(c, f) + "\n";
      truth.push_back({to_ns(f / kRate_hz), pose_of(c, image_of(f))});
    }
    folder_.write(name(c) + ".csv", list);
    save_tum(folder_ / (name(c) + ".tum"), truth);
    yaml += "  - {name: " + name(c) + ", source: " + name(c) +
            ".csv, calibration: calibration.yaml, truth: " + name(c) + ".tum}\n";
  }
  folder_.write("sequence.yaml", yaml);
}

std::string SmallScene::image(int camera, int frame) const {
  std::string number = std::to_string(image_of(frame));
  number.insert(0, 6 - number.size(), '0');
  return (folder_ / name(camera) / (number + ".png")).string();
}

std::vector<std::string> SmallScene::agent(int camera, const std::string& domain, const std::string& rate) const {
  std::vector<std::string> arguments{"--loopback", "--domain", domain};
  arguments.insert(arguments.end(), {"--id", name(camera), "--source", source(camera)});
  arguments.insert(arguments.end(), {"--calibration", calibration(), "--rate", rate});
  return arguments;
}

}  // namespace coslam::test
