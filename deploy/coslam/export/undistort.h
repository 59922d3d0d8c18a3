// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "deploy/coslam/export/colmap_model.h"

namespace coslam::exporting {

// The pinhole camera, without distortion, that shows the most of a lens's image: with its focal lengths, so that the
// middle keeps its pixels; with the optical axis in the middle, as some programs take for granted; and every pixel of
// it has a place in the image, so that there is no black border. Nothing farther than 60 degrees to either side, or up
// or down, where a pixel of the middle would be drawn out to four.
CameraModel pinhole_of(const CameraModel& lens);

// An image of the lens as the pinhole would have taken it.
class Undistorter {
 public:
  Undistorter(const CameraModel& lens, const CameraModel& pinhole);
  cv::Mat operator()(const cv::Mat& image) const;

 private:
  cv::Mat x_, y_;  // raw px of each pixel of the pinhole
};

// Puts pinholes in the place of the lenses. What they do not show is dropped.
void undistort_model(ColmapModel* model);

// Writes the images of an undistorted model to <folder>/<their names>, in colour where the source has it, and gives
// the points the colours that they have there. lenses: as of model->cameras, before. Throws UserError.
void write_undistorted_images(const std::vector<CameraModel>& lenses, double rate_hz,
                              const std::filesystem::path& folder, ColmapModel* model);

}  // namespace coslam::exporting
