// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "common/geometry/camera_model.h"
#include "common/geometry/rigid3.h"

namespace coslam::test {

// A chessboard of 7 x 5 inner corners in the plane z = 0, 3 cm a square.
struct FilmedBoard {
  static constexpr int kColumns = 7, kRows = 5;
  static constexpr double kSquare_m = 0.03;

  // The squares reach from -1 to kColumns, kRows, with a white border around.
  static double grey_at(double column, double row) {
    if (column < -1 || row < -1 || column > kColumns || row > kRows) return 230;
    return (static_cast<int>(std::floor(column)) + static_cast<int>(std::floor(row))) % 2 == 0 ? 25 : 230;
  }
};

// A camera before the board, with a shutter that takes time: rows one after the other, each while the light falls in.
class BoardFilm {
 public:
  struct Shutter {
    double readout_s = 0, exposure_s = 0;
    int instants = 1;  // of the exposure
  };
  using Path = std::function<Rigid3(double t_s)>;  // board from camera

  BoardFilm(const CameraModel& camera, const Shutter& shutter) : camera_(camera), shutter_(shutter) {
    for (int v = 0; v < camera.height_px; ++v) {
      for (int u = 0; u < camera.width_px; ++u) {
        for (const double du : {-0.25, 0.25}) {
          for (const double dv : {-0.25, 0.25}) {
            const auto px = camera.undistorted_from_raw({u + du, v + dv});
            rays_.emplace_back(px ? camera.normalized_from_pixel(*px) : Eigen::Vector2d(0, 0));
          }
        }
      }
    }
  }

  cv::Mat picture(const Path& path, double t_s) const {
    cv::Mat picture(camera_.height_px, camera_.width_px, CV_8U);
    std::vector<Rigid3> poses(static_cast<std::size_t>(shutter_.instants));
    for (int v = 0; v < picture.rows; ++v) {
      const double row_s = t_s + shutter_.readout_s * v / picture.rows;
      for (int i = 0; i < shutter_.instants; ++i) {
        poses[static_cast<std::size_t>(i)] = path(row_s + shutter_.exposure_s * i / shutter_.instants);
      }
      for (int u = 0; u < picture.cols; ++u) picture.at<std::uint8_t>(v, u) = grey(poses, v * picture.cols + u);
    }
    return picture;
  }

 private:
  std::uint8_t grey(const std::vector<Rigid3>& poses, int pixel) const {
    double sum = 0;
    for (const Rigid3& board_from_cam : poses) {
      for (int i = 0; i < 4; ++i) {
        const Eigen::Vector3d ray =
            board_from_cam.rotation * rays_[static_cast<std::size_t>(4 * pixel + i)].homogeneous();
        const Eigen::Vector3d hit = board_from_cam.translation - board_from_cam.translation.z() / ray.z() * ray;
        sum += FilmedBoard::grey_at(hit.x() / FilmedBoard::kSquare_m, hit.y() / FilmedBoard::kSquare_m);
      }
    }
    return static_cast<std::uint8_t>(sum / static_cast<double>(4 * poses.size()));
  }

  CameraModel camera_;
  Shutter shutter_;
  std::vector<Eigen::Vector2d> rays_;  // four a pixel
};

}  // namespace coslam::test
