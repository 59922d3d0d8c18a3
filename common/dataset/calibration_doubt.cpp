// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/calibration_doubt.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/printed.h"
#include "common/geometry/lens_forms.h"

namespace coslam {
namespace {

// Measures of how unlike a usual camera one is. Anamorphic lenses, fields of interlaced video and images that were cut
// out of others lie between the two of a kind.
constexpr double kOddAspect = 1.1, kHopelessAspect = 2.5;
constexpr double kOddOffCentre = 0.25, kHopelessOffCentre = 0.4;     // of the image's size
constexpr double kOddTangential = 0.01, kHopelessTangential = 0.05;  // the first is a sensor tilted by 2 degrees
constexpr double kShortestPinhole = 0.15;                            // of the larger side: 147 degrees across

using Projection = std::array<double, 4>;  // fx fy cx cy, as the file has them

Projection projection_of(const CameraModel& c) {
  const double scale = focal_in_files(c);
  return {c.fx * scale, c.fy * scale, c.cx, c.cy};
}

double aspect(double fx, double fy) { return std::max(fx / fy, fy / fx); }

double off_centre(const CameraModel& c, double cx, double cy) {
  return std::max(std::abs(cx - 0.5 * (c.width_px - 1)) / c.width_px,
                  std::abs(cy - 0.5 * (c.height_px - 1)) / c.height_px);
}

// A usual camera comes out where the four numbers are read in another order: which; else empty.
std::string other_order(const CameraModel& c) {
  constexpr double kSquare = 1.03, kMiddle = 0.1;
  const Projection p = projection_of(c);
  const auto usual = [&](double fx, double fy, double cx, double cy) {
    return aspect(fx, fy) < kSquare && off_centre(c, cx, cy) < kMiddle;
  };
  if (usual(p[0], p[1], p[2], p[3])) return {};
  if (usual(p[0], p[2], p[1], p[3])) return "fx cx fy cy";
  if (usual(p[2], p[3], p[0], p[1])) return "cx cy fx fy";
  return {};
}

// The radius in raw pixels from which on rays that come in at larger angles are seen farther in again, where that is
// well inside the image: what is fitted to a picture often folds just outside what was seen of the board.
std::optional<double> fold_px(const CameraModel& c) {
  constexpr double kWell = 0.9, kWidest_rad = 1.5, kStep_rad = 0.005;
  constexpr int kDirections = 16;
  const Eigen::Vector2d middle(c.cx, c.cy);
  double nearest_px = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kDirections; ++i) {
    const double turn = 2 * std::numbers::pi * i / kDirections;
    for (double angle = kStep_rad; angle < kWidest_rad; angle += kStep_rad) {
      Eigen::Matrix2d by_n;
      const Eigen::Vector2d n = std::tan(angle) * Eigen::Vector2d(std::cos(turn), std::sin(turn));
      const Eigen::Vector2d from_middle = c.pixel_from_normalized(c.distort_normalized(n, &by_n)) - middle;
      if (!c.contains_raw(middle + from_middle / kWell)) break;
      if (by_n.determinant() > 0) continue;
      nearest_px = std::min(nearest_px, from_middle.norm());
      break;
    }
  }
  return std::isfinite(nearest_px) ? std::optional(nearest_px) : std::nullopt;
}

// No lens takes a cone of rays to a smaller circle than r = sin(angle), which makes every part of the picture as bright
// as its middle; calibrations are off by less than this at their edges.
bool squeezes_beyond_lenses(const CameraModel& c) {
  constexpr double kBeyond = 0.97, kStep_rad = 0.005, kWidest_rad = 1.5;
  for (double angle = kStep_rad; angle < kWidest_rad; angle += kStep_rad) {
    const Eigen::Vector2d seen = c.distort_normalized({std::tan(angle), 0});
    if (!c.contains_raw(c.pixel_from_normalized(seen))) return false;
    if (seen.x() < kBeyond * std::sin(angle)) return true;
  }
  return false;
}

// Of five as some programs write them, read in the order of OpenCV: a term of the radius in the place of p1, and no
// larger ones in those of p2 and k3 than tangential ones are.
bool is_k3_before_tangential(const CameraModel& c) {
  constexpr double kMostTangential = 0.005;
  const auto& k = c.coefficients;
  return k[4] != 0 && std::abs(k[2]) > kOddTangential && std::abs(k[3]) < kMostTangential &&
         std::abs(k[4]) < kMostTangential;
}

// Of the coefficients; the focal length may be right.
CalibrationDoubt doubt_of_distortion(const CameraModel& c) {
  const bool radtan = c.distortion == DistortionModel::kRadTan;
  if (c.distortion == DistortionModel::kEquidistant && squeezes_beyond_lenses(c))
    return {
        "an equidistant lens of these coefficients would squeeze the sides of the picture more than any does: are "
        "they radtan's k1 k2 p1 p2?",
        true, c.focal_px()};
  if (radtan && is_k3_before_tangential(c))
    return {
        printed("coefficients of %.3g %.3g %.3g %.3g %.3g: are they in the order k1 k2 k3 p1 p2, and not k1 k2 p1 p2 "
                "k3?",
                c.coefficients[0], c.coefficients[1], c.coefficients[2], c.coefficients[3], c.coefficients[4]),
        true, c.focal_px()};
  const std::string order = radtan ? ": are they in the order k1 k2 p1 p2 k3?" : ": are they in their order?";
  const double tangential = radtan ? std::max(std::abs(c.coefficients[2]), std::abs(c.coefficients[3])) : 0;
  if (tangential > kHopelessTangential)
    return {printed("a tangential coefficient of %.3g is more than any lens has", tangential) + order, true,
            c.focal_px()};
  if (const auto fold = fold_px(c))
    return {printed("its distortion coefficients fold the picture from %.0f px around the middle on", *fold) + order,
            true, c.focal_px()};
  if (tangential > kOddTangential)
    return {printed("a tangential coefficient of %.3g is more than most lenses have", tangential) + order, false, {}};
  return {};
}

CalibrationDoubt doubt_of_focal(const CameraModel& c) {
  const auto [fx, fy, cx, cy] = projection_of(c);
  if (!lens_traits(c.distortion).fisheye && c.fx < kShortestPinhole * std::max(c.width_px, c.height_px))
    return {printed("a lens without the distortion of a fisheye has no focal length as short as %.1f px of %d: is it "
                    "an angle?",
                    c.fx, c.width_px),
            true,
            {}};
  if (aspect(fx, fy) < kOddAspect) return {};
  return {printed("its focal lengths, fx %.1f and fy %.1f px, are far apart: a slip in one of them?", fx, fy),
          aspect(fx, fy) > kHopelessAspect,
          {}};
}

CalibrationDoubt doubt_of_centre(const CameraModel& c) {
  const double off = off_centre(c, c.cx, c.cy);
  if (off < kOddOffCentre - 0.01) return {};
  const double x = (c.cx + 0.5) / (0.5 * c.width_px), y = (c.cy + 0.5) / (0.5 * c.height_px);
  const bool other_size = aspect(x, y) < 1.15;
  std::string text = printed("its principal point, (%.1f, %.1f), is far from the middle of %dx%d pixels: ", c.cx, c.cy,
                             c.width_px, c.height_px);
  text += other_size ? printed("is it for images of about %.0fx%.0f?", x * c.width_px, y * c.height_px)
                     : "is it for images of another size?";
  return {text, other_size || off > kHopelessOffCentre, {}};
}

}  // namespace

CalibrationDoubt doubt_of(const CameraModel& camera, bool part) {
  if (camera.guessed()) return {};
  if (const std::string order = other_order(camera); !order.empty() && !part) {
    const auto [fx, fy, cx, cy] = projection_of(camera);
    return {printed("fx fy cx cy are %.1f %.1f %.1f %.1f: are they %s?", fx, fy, cx, cy, order.c_str()), true, {}};
  }
  CalibrationDoubt first;
  for (const CalibrationDoubt& doubt :
       {doubt_of_distortion(camera), doubt_of_focal(camera), part ? CalibrationDoubt() : doubt_of_centre(camera)}) {
    if (doubt.hopeless) return doubt;
    if (first.text.empty()) first = doubt;
  }
  return first;
}

std::string unit_problem_of(const CameraModel& camera) {
  constexpr double kShortest = 0.1, kLongest = 50;  // of the larger side
  const double side = std::max(camera.width_px, camera.height_px), longest = std::max(camera.fx, camera.fy);
  const bool too_short = longest < kShortest * side;
  if (!too_short && std::min(camera.fx, camera.fy) <= kLongest * side) return {};
  return printed("no lens has a focal length of %.4g pixels for images of %dx%d", longest, camera.width_px,
                 camera.height_px) +
         (too_short ? ": is it in millimetres, or a share of the size?" : "");
}

}  // namespace coslam
