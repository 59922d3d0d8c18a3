// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/places/depth_ratio.h"

#include <algorithm>
#include <cmath>

namespace coslam {

std::optional<DepthRatio> depth_ratio(std::vector<double> log_ratios) {
  constexpr double kMostSpread = 0.3;  // between the quartiles
  if (log_ratios.size() < kLeastDepthRatios) return std::nullopt;
  std::ranges::sort(log_ratios);
  const std::size_t n = log_ratios.size();
  const double spread = log_ratios[n * 3 / 4] - log_ratios[n / 4];
  if (spread > kMostSpread) return std::nullopt;
  constexpr double kSigmaOfSpread = 1 / 1.349, kOfMedian = 1.2533;  // of a normal distribution
  return DepthRatio{std::exp(log_ratios[n / 2]),
                    kOfMedian * kSigmaOfSpread * spread / std::sqrt(static_cast<double>(n))};
}

double likely_scale(const Map& map, const LoopConstraint& loop, double log_sigma) {
  constexpr double kLeastDrift = 0.002;
  const MapCamera& camera = map.camera(loop.camera);
  const FramePose *here = camera.frame_at(loop.set), *there = map.camera(loop.to_camera).frame_at(loop.to_set);
  if (here == nullptr || there == nullptr) return loop.scale;
  const Eigen::Vector3d center = here->cam_from_world.center();
  double width = 0;
  for (auto f = camera.frames.rbegin(); f != camera.frames.rend() && f->set >= loop.to_set; ++f) {
    if (f->map == here->map) width = std::max(width, (f->cam_from_world.center() - center).norm());
  }
  const double missing = ((loop.camera_from_to * there->cam_from_world).center() - center).norm();
  if (!(width > 0)) return loop.scale;
  const double drift = std::max(kLeastDrift, 2 * missing / width);
  return std::pow(loop.scale, drift * drift / (drift * drift + log_sigma * log_sigma));
}

}  // namespace coslam
