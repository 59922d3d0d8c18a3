// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <span>

#include "server/estimator/map/camera_pen.h"

namespace coslam {

// The logarithm of how much longer the focal length of an image is than its camera's lens says.
struct FrameZoom {
  SetId set;
  double log_zoom = 0;
};

// Verbs on lenses: what was observed through the older lens comes to where the new one has it.
class LensPen : public CameraPen {
 protected:
  using CameraPen::CameraPen;

  // What is wrong about the camera's calibration, as far as it is known now: all that it saw is where the new lens has
  // it.
  void correct_lens(const MapCamera& camera, const LensCorrection& lens, const LensCorrection::Values& sigma);
  // The camera's focal length changes from image to image, by up to this share.
  void note_breathing(const MapCamera& camera, double most) {
    own(camera).breathing = std::max(camera.breathing, most);
  }
  // All that a camera saw comes to where it would be without zooms, which go evenly from one of these (ascending) to
  // the next.
  void leave_zoom_out(const MapCamera& camera, std::span<const FrameZoom> zooms);

  // Another calibration: what the camera saw before is where the new one would have seen it.
  void change_model(MapCamera* camera, const CameraModel& model);

 private:
  // Moves all places in images at which the camera saw something.
  void move_observations(MapCamera* camera, const std::function<void(Eigen::Vector2f*)>& move);
};

}  // namespace coslam
