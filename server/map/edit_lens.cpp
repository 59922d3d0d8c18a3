// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What was observed through the older lens comes to where the new one has it.
#include <cmath>

#include "server/map/edit.h"
#include "server/map/lens_step.h"

namespace coslam {

void MapEdit::correct_lens(const MapCamera& camera, const LensCorrection& lens, const LensCorrection::Values& sigma) {
  MapCamera& c = own(camera);
  const LensCorrection before = c.lens;
  c.lens.values = lens.values.cast<float>().cast<double>();  // as its agent is told
  c.lens_sigma = sigma;
  const LensStep step(c.model, before, c.lens);
  ++map_.lens_changes_;
  for (auto& [id, track] : c.tracks) {
    for (TrackPoint& p : track.seen) step.move(&p.undistorted_px);
  }
  for (FramePose& frame : c.frames) {
    for (HeldTrack& held : frame.held) step.move(&held.undistorted_px);
  }
  for (auto& [id, point] : map_.points_) {
    for (KeyObservation& o : point.key_observations) {
      if (o.camera == c.id) step.move(&o.undistorted_px);
    }
  }
  for (auto& [id, samples] : map_.motions_) {
    for (MotionSample& sample : samples) {
      for (Sighting& s : sample.seen) {
        if (s.camera != c.id) continue;
        Eigen::Vector2f earlier = s.undistorted_px - s.step_px;
        step.move(&earlier);
        step.move(&s.undistorted_px);
        s.step_px = s.step_px.isZero(0) ? s.step_px : Eigen::Vector2f(s.undistorted_px - earlier);
      }
    }
  }
  note_camera(EventKind::kCameraLens, c, Why::kLensFound, {std::exp(lens.log_focal()), lens.centre_px().norm()});
}

}  // namespace coslam
