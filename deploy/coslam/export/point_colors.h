// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <opencv2/core/mat.hpp>

#include "deploy/coslam/export/colmap_model.h"

namespace coslam::exporting {

// Mean colours of points in the images that see them.
class PointColors {
 public:
  // image: with the pixels of the model's camera.
  void add(const cv::Mat& image, const ColmapModel::Image& seen);
  void give(ColmapModel* model) const;

 private:
  struct Sum {
    cv::Vec3d bgr{0, 0, 0};
    int images = 0;
  };
  std::map<PointId, Sum> sums_;
};

// Makes the folder too. Throws UserError.
void write_image(const std::filesystem::path& file, const cv::Mat& image);

// Each image of one camera of the model with its pixels as they were taken, by that lens. Throws UserError.
void see_images(const ColmapModel& model, std::size_t camera, const CameraModel& lens, double rate_hz,
                const std::function<void(const ColmapModel::Image&, const cv::Mat&)>& visit);

}  // namespace coslam::exporting
