// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "server/estimator/map/map.h"

namespace coslam {

// Zero-mean normalised cross correlation of two patches, -1 to 1; 0 for a flat patch.
double zncc(const PatchGrey& a, const PatchGrey& b);

// Tells whether two patches are centred on the same thing: the peak of their correlation lies within a pixel or so of
// the image (0.4 of the patch's, which are 3.3 times as large). Corners that two cameras found on one structure often
// do not.
bool same_centre(const PatchGrey& a, const PatchGrey& b);

// Finds the middle of `a` in `b`, searching around b's centre: the corners that two cameras follow on one structure are
// often some pixels apart. Uses the middle alone, since around something thin that moves the patch shows the
// background. Empty where there is no peak.
inline constexpr double kMostShift_px = 5;
struct PatchPeak {
  double zncc = -1;                                    // correlation of the middle, 7 x 7
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  // offset from b's centre, pixels of the image
};
std::optional<PatchPeak> peak_in(const PatchGrey& a, const PatchGrey& b);

// Warps a patch as if its content moved by image_from_other (2 x 2): what `other` shows at image_from_other^-1 * d, the
// result shows at d. Repeats the border where `other` ends.
PatchGrey warped(const PatchGrey& other, const Eigen::Matrix2d& image_from_other);

// View of a place by a camera at a pose.
struct PatchSight {
  const MapCamera* camera = nullptr;
  Rigid3 cam_from_world;
  const PatchGrey* patch = nullptr;
};

// Two patches of one place, both warped into the view of the camera that shows less of its detail. The place is taken
// to lie on a plane that faces between the two views, so that the cameras may be turned about their axes and at
// different distances.
struct AlikePatches {
  PatchGrey first, second;
  bool in_second = false;          // the view is that of the second camera
  Eigen::Matrix2d second_by_view;  // pixels of the second image by pixels of the view
};
// Warps two patches of a place into one view; empty when their scales differ too much.
std::optional<AlikePatches> made_alike(const PatchSight& first, const PatchSight& second,
                                       const Eigen::Vector3d& position);

struct PatchFit {
  double zncc = -1;
  bool same_centre = false;
};

// Compares a patch that a camera sees at this pose with the point's patch from the nearest direction so far. Empty when
// the point has no patch from within 60 degrees.
std::optional<PatchFit> fit_patch(const Map& map, const MapPoint& point, const MapCamera& camera,
                                  const Rigid3& cam_from_world, const PatchGrey& patch);

}  // namespace coslam
