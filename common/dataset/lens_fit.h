// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "common/geometry/camera_model.h"

namespace coslam {

// The distance from the principal point, in focal lengths, of what is seen at an angle (rad) from the optical axis.
using RadiusOfAngle = std::function<double(double)>;

// A field-of-view lens (Devernay and Faugeras): atan(2 tan(angle) tan(w/2)) / w.
RadiusOfAngle field_of_view_lens(double w_rad);
// The extended unified camera model (Khomutenko et al.), with fx, fy as its files have them.
RadiusOfAngle extended_unified_lens(double alpha, double beta);

// Distance from the principal point to the farthest corner of the image, in focal lengths.
double farthest_corner(const CameraModel& camera);

struct FittedLens {
  CameraModel camera;
  double miss_px = 0;  // the largest, in the image
};

// The equidistant lens (k1 to k4) nearest to one that bends rays by their angle alone, over the image: least squares
// over angles up to where the farthest corner is seen. camera: size, principal point and focal lengths of that lens.
FittedLens fit_equidistant(const CameraModel& camera, const RadiusOfAngle& radius);

// Sentence on a fit for the log.
std::string fit_said(const std::string& model, const FittedLens& fit);

}  // namespace coslam
