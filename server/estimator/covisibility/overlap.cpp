// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/covisibility/overlap.h"

namespace coslam {
namespace {

// Of what the one camera sees, so much could be in the other's image at most: a long lens shows a small part of what a
// wide one does.
double most_shared(const CameraModel& seen, const CameraModel& seeing) {
  constexpr double kAlike = 0.5;
  const auto solid = [](const CameraModel& c) { return (c.width_px / c.fx) * (c.height_px / c.fy); };
  const double ratio = solid(seeing) / solid(seen);
  return ratio < kAlike ? ratio : 1;
}

}  // namespace

int ViewOverlap::cell_of(const CameraModel& model, const Eigen::Vector2d& px) {
  const double x = px.x() / model.width_px, y = px.y() / model.height_px;
  if (!(x >= 0 && x < 1 && y >= 0 && y < 1)) return -1;
  return static_cast<int>(y * kRows) * kColumns + static_cast<int>(x * kColumns);
}

const ViewOverlap::Sight& ViewOverlap::sight_of(const MapCamera& camera) {
  const auto [at, added] = sights_.try_emplace(camera.id);
  Sight& sight = at->second;
  if (!added) return sight;
  for (const auto& [id, t] : camera.tracks) {
    const MapPoint* p = map_.find(t.point);
    if (p == nullptr || !p->rests()) continue;
    const int cell = cell_of(camera.model, t.seen.back().undistorted_px.cast<double>());
    const double depth = (camera.frames.back().cam_from_world * p->position).z();
    if (cell < 0 || depth <= 0) continue;
    sight.seen.push_back({p->position, cell});
    Depths& d = sight.depths[static_cast<std::size_t>(cell)];
    d.least = std::min(d.least, depth);
    d.most = std::max(d.most, depth);
  }
  return sight;
}

bool ViewOverlap::should_see(const MapCamera& camera, const Sight& sight, const Eigen::Vector3d& position) {
  constexpr double kBeside = 1.25;  // nearer or farther than what it follows around there
  const Rigid3& pose = camera.frames.back().cam_from_world;
  Eigen::Vector2d px;
  if (!project_world(camera.model, pose, position, &px)) return false;
  const int cell = cell_of(camera.model, px);
  if (cell < 0) return false;
  Depths around;
  const int column = cell % kColumns, row = cell / kColumns;
  for (int y = std::max(0, row - 1); y <= std::min(kRows - 1, row + 1); ++y) {
    for (int x = std::max(0, column - 1); x <= std::min(kColumns - 1, column + 1); ++x) {
      const Depths& d = sight.depths[static_cast<std::size_t>(y * kColumns + x)];
      around.least = std::min(around.least, d.least);
      around.most = std::max(around.most, d.most);
    }
  }
  const double depth = (pose * position).z();
  return depth > around.least / kBeside && depth < kBeside * around.most;
}

double ViewOverlap::share_seen(const CameraFrames& seen_camera, const Sight& seen_sight, const MapCamera& seeing_camera,
                               const Sight& seeing_sight) {
  constexpr double kMostApart = 0.6;  // cosine, between the rays
  const Eigen::Vector3d from = seen_camera.frames.back().cam_from_world.center(),
                        other = seeing_camera.frames.back().cam_from_world.center();
  const auto seen_alike = [&](const Eigen::Vector3d& p) {
    return (p - from).normalized().dot((p - other).normalized()) > kMostApart;
  };
  std::array<bool, kColumns * kRows> occupied{}, shared{};
  for (const Seen& s : seen_sight.seen) {
    const auto cell = static_cast<std::size_t>(s.cell);
    occupied[cell] = true;
    if (!shared[cell]) shared[cell] = should_see(seeing_camera, seeing_sight, s.position) && seen_alike(s.position);
  }
  const auto all = std::count(occupied.begin(), occupied.end(), true);
  return all == 0 ? 0 : static_cast<double>(std::count(shared.begin(), shared.end(), true)) / static_cast<double>(all);
}

OverlapShares ViewOverlap::between(CameraId first, CameraId second) {
  const MapCamera &a = map_.camera(first), &b = map_.camera(second);
  if (a.frames.empty() || b.frames.empty()) return {};
  const FramePose &fa = a.frames.back(), &fb = b.frames.back();
  const bool one_time = std::abs(fa.capture_ns - fb.capture_ns) <= to_ns(kOneTime_s);
  if (!fa.valid() || fa.map != fb.map || !one_time) return {};
  const Sight &of_first = sight_of(a), &of_second = sight_of(b);
  return {std::min(1.0, share_seen(a, of_first, b, of_second) / most_shared(a.model, b.model)),
          std::min(1.0, share_seen(b, of_second, a, of_first) / most_shared(b.model, a.model))};
}

}  // namespace coslam
