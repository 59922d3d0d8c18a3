// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <span>

#include "server/estimator/map/camera_pen.h"

namespace coslam {

// Zoom of one image (focus breathing): logarithm of how much longer its focal length is than its camera's lens says.
struct FrameZoom {
  SetId set;
  double log_zoom = 0;
};

// Verbs on lenses: they move observations from where the older lens has them to where the new one does.
class LensPen : public CameraPen {
 protected:
  using CameraPen::CameraPen;

  // Sets the camera's lens correction, as far as it is known now, and moves all its observations to where the new lens
  // has them.
  void correct_lens(const MapCamera& camera, const LensCorrection& lens, const LensCorrection::Values& sigma);
  // Notes that the camera's focal length changes from image to image, by up to this share.
  void note_breathing(const MapCamera& camera, double most) {
    mutable_camera(camera).breathing = std::max(camera.breathing, most);
  }
  // Corrects all observations of a camera for its zooms, which are interpolated between these (sorted).
  void leave_zoom_out(const MapCamera& camera, std::span<const FrameZoom> zooms);

  // Sets another calibration: earlier observations move to where the new one would have seen them.
  void change_model(MapCamera* camera, const CameraModel& model);

 private:
  // Moves all places in images at which the camera saw something.
  void move_observations(MapCamera* camera, const std::function<void(Eigen::Vector2f*)>& move);
};

}  // namespace coslam
