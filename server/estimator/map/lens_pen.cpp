// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/lens_pen.h"

#include <algorithm>
#include <cmath>

#include "server/estimator/map/lens_step.h"

namespace coslam {
namespace {

// From where a camera saw something in an image to where it would have without the zoom of that.
class ZoomSteps {
 public:
  ZoomSteps(const MapCamera& camera, std::span<const FrameZoom> zooms)
      : camera_(camera.model),
        lens_(camera.model, camera.lens),
        centre_(Eigen::Vector2d(camera.model.cx, camera.model.cy) + camera.lens.centre_px()),
        zooms_(zooms) {}

  double log_zoom(SetId set) const {
    const auto after = std::ranges::lower_bound(zooms_, set, {}, &FrameZoom::set);
    if (after == zooms_.end()) return zooms_.back().log_zoom;
    if (after == zooms_.begin()) return after->log_zoom;
    const FrameZoom& before = *(after - 1);
    const double s = static_cast<double>(set.value - before.set.value) / (after->set.value - before.set.value);
    return (1 - s) * before.log_zoom + s * after->log_zoom;
  }
  void move(SetId set, Eigen::Vector2f* undistorted_px) const {
    const Eigen::Vector2d normalized = camera_.normalized_from_pixel(undistorted_px->cast<double>());
    const Eigen::Vector2d off = lens_.raw_from_normalized(normalized) - centre_;
    const auto n = lens_.normalized_from_raw(centre_ + std::exp(-log_zoom(set)) * off, normalized);
    if (n) *undistorted_px = camera_.pixel_from_normalized(*n).cast<float>();
  }

 private:
  const CameraModel& camera_;
  CorrectedLens lens_;
  Eigen::Vector2d centre_;
  std::span<const FrameZoom> zooms_;
};

}  // namespace

void LensPen::correct_lens(const MapCamera& camera, const LensCorrection& lens, const LensCorrection::Values& sigma) {
  MapCamera& c = mutable_camera(camera);
  const LensCorrection before = c.lens;
  c.lens.values = lens.values.cast<float>().cast<double>();  // as its agent is told
  c.lens_sigma = sigma;
  const LensStep step(c.model, before, c.lens);
  move_observations(&c, [&](Eigen::Vector2f* px) { step.move(px); });
  note_camera(EventKind::kCameraLens, c, Why::kLensFound, {std::exp(lens.log_focal()), lens.centre_px().norm()});
}

void LensPen::change_model(MapCamera* c, const CameraModel& model) {
  if (c->model == model) return;
  move_observations(c, [&, before = c->model](Eigen::Vector2f* px) {
    *px = model.pixel_from_normalized(before.normalized_from_pixel(px->cast<double>())).cast<float>();
  });
  c->model = model;
  c->lens = {};
  c->lens_sigma.setZero();
  c->breathing = 0;
}

void LensPen::move_observations(MapCamera* camera, const std::function<void(Eigen::Vector2f*)>& move) {
  MapCamera& c = *camera;
  for (auto& [id, track] : c.tracks) {
    for (TrackPoint& p : track.seen) move(&p.undistorted_px);
  }
  for (FramePose& frame : c.frames) {
    for (HeldTrack& held : frame.held) move(&held.undistorted_px);
  }
  for (auto& [id, point] : map_.points_.all) {
    for (KeyObservation& o : point.key_observations) {
      if (o.camera == c.id) move(&o.undistorted_px);
    }
  }
  for (auto& [id, samples] : map_.motions_) {
    for (MotionSample& sample : samples) {
      for (Sighting& s : sample.seen) {
        if (s.camera != c.id) continue;
        Eigen::Vector2f earlier = s.undistorted_px - s.step_px;
        move(&earlier);
        move(&s.undistorted_px);
        s.step_px = s.step_px.isZero(0) ? s.step_px : Eigen::Vector2f(s.undistorted_px - earlier);
      }
    }
  }
}

void LensPen::leave_zoom_out(const MapCamera& camera, std::span<const FrameZoom> zooms) {
  if (zooms.empty()) return;
  MapCamera& c = mutable_camera(camera);
  const ZoomSteps steps(c, zooms);
  for (auto& [id, track] : c.tracks) {
    for (TrackPoint& p : track.seen) steps.move(p.set, &p.undistorted_px);
  }
  for (FramePose& frame : c.frames) {
    for (HeldTrack& held : frame.held) steps.move(frame.set, &held.undistorted_px);
    frame.zoom_taken_out += static_cast<float>(steps.log_zoom(frame.set));
  }
  for (auto& [id, point] : map_.points_.all) {
    for (KeyObservation& o : point.key_observations) {
      if (o.camera == c.id) steps.move(o.set, &o.undistorted_px);
    }
  }
}

}  // namespace coslam
