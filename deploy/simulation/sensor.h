// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "common/geometry/camera_model.h"

namespace coslam::sim {

// Model of the sensor: exposure that drifts, fall-off towards the corners, photon and read noise, a tone curve.
struct SensorModel {
  double gain = 1;      // share of full scale for radiance 1
  double drift = 0.06;  // relative amplitude of the slow change of the gain
  double drift_period_s = 9;
  double drift_phase_rad = 0;
  double vignetting = 0.25;  // loss in the image corner
  double full_well_e = 18000;
  double read_noise_e = 15;
  double gamma = 1.7;
  std::uint64_t seed = 0;
};

// A camera with 640 x 480 pixels at scale 1. Lenses:
//   ""           that of camera `index`: each of the first three differs, further ones repeat them
//   pinhole      without distortion
//   radtan, ...  one of known_lenses(), each a lens model
//   fisheyeN     equidistant, N degrees from corner to corner, 60 to 170
// Throws UserError for another one.
CameraModel simulated_camera(int index, double image_scale = 1.0, const std::string& lens = {});
// Names of the lens models that cameras may have: "pinhole, radtan, ...".
std::string known_lenses();
SensorModel simulated_sensor(int index, std::uint64_t seed);

// The 8-bit image of a radiance image. The same sensor and frame give the same noise.
cv::Mat1b expose(const cv::Mat1f& radiance, const SensorModel& sensor, int frame, double t_s);

}  // namespace coslam::sim
