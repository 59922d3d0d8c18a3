// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/co_moving.h"

#include <algorithm>
#include <vector>

#include "server/estimator/motion/rest_hypothesis.h"

namespace coslam {
namespace {

// It hardly moves in the view, while others pass by: infinitely far, or it goes along with the camera.
bool keeps_its_distance(std::span<const View> views, double median_depth, double most_px) {
  constexpr double kOfParallax = 0.15;
  const double passed_px = parallax_px(views, median_depth);
  return passed_px > 2 * most_px && far_miss_px(views) < std::max(most_px, kOfParallax * passed_px);
}

}  // namespace

double parallax_px(std::span<const View> views, double median_depth) {
  const double baseline = (views.front().cam_from_world.center() - views.back().cam_from_world.center()).norm();
  return median_depth > 0 ? baseline / median_depth * views.front().camera->focal_px() : 0;
}

bool goes_on_with_camera(const ServerTrack& track, std::span<const View> views, double median_depth, double most_px) {
  return track.moves() && keeps_its_distance(views, median_depth, most_px);
}

std::optional<SetId> co_moving_since(const MapCamera& camera, const ServerTrack& track, double median_depth,
                                     const EvidenceConfig& config) {
  std::vector<View> views;  // newest first
  std::vector<const FramePose*> frames;
  for (auto seen = track.seen.rbegin(); seen != track.seen.rend(); ++seen) {
    const FramePose* f = camera.frame_at(seen->set);
    if (f == nullptr || f->map != camera.map) continue;
    views.push_back({&camera.model, f->cam_from_world, seen->undistorted_px.cast<double>()});
    frames.push_back(f);
  }
  const TimeNs time_ns = to_ns(config.test_s);
  const auto before = [&](std::size_t from, TimeNs by_ns) {
    while (from < frames.size() && frames[from]->capture_ns >= camera.frames.back().capture_ns - by_ns) ++from;
    return from;
  };
  std::optional<SetId> start;
  // The newest time shows that it moves; windows that overlap by half go back from there.
  for (int halves = 2;; ++halves) {
    const std::size_t begin = before(0, halves * time_ns / 2), end = before(begin, (halves + 2) * time_ns / 2);
    if (end < begin + kLeastFrames) break;
    const auto window = std::span(views).subspan(begin, end - begin);
    if (!keeps_its_distance(window, median_depth, camera.model.px_from_640(config.doubtful_px))) break;
    start = frames[end - 1]->set;
  }
  return start;
}

}  // namespace coslam
