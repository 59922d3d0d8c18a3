// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/rebind.h"

#include <algorithm>
#include <vector>

#include "server/estimator/associate/patch_match.h"
#include "server/estimator/associate/track_grid.h"
#include "server/estimator/map/sighting.h"

namespace coslam {
namespace {

struct Look {
  const ServerTrack* track = nullptr;
  double zncc = -1;
  Eigen::Vector2f offset_px = Eigen::Vector2f::Zero();
};

// How a track looks beside the newest of the point's patches.
Look look_of(const MapPoint& p, const ServerTrack& t) {
  Look best{&t};
  for (std::size_t i = p.patches.size(); i-- > 0 && p.patches.size() - i <= kPatchesOfPoint;) {
    const PointPatch& known = p.patches[i];
    const auto peak = peak_in(known.pixels, *t.patch);
    if (peak && peak->zncc > best.zncc) best = {&t, peak->zncc, known.offset_px + peak->shift_px.cast<float>()};
  }
  return best;
}

// The free track that looks most like the point, where it should be.
Look find_track(const Map& map, const MapCamera& camera, const TrackGrid& grid, const MapPoint& p,
                const FollowConfig& config) {
  const double gate_px = map.gate_sigma_px(camera), most_px = camera.model.px_from_640(config.search_px);
  const auto window = search_window(camera.model, camera.frames.back().cam_from_world, p, gate_px, map.config().theta);
  if (!window) return {};
  Look best;
  double second = -1;
  const double radius_px = std::min(window->radius_px + kMostShift_px, most_px);
  grid.near(window->px, radius_px, [&](const TrackGrid::InGrid& t) {
    if ((t.px - window->px).norm() > radius_px) return;
    const Look look = look_of(p, *t.track);
    second = std::max(second, std::min(look.zncc, best.zncc));
    if (look.zncc > best.zncc) best = look;
  });
  return best.zncc >= map.config().zncc_min && best.zncc - second >= map.config().zncc_margin ? best : Look{};
}

// With what other cameras see of the point now.
bool agrees(const Map& map, const MapCamera& camera, const MapPoint& p, const Look& look) {
  std::vector<Seen> seen = seen_now(map, p);
  if (seen.empty()) return true;
  auto view = view_at(camera, *look.track, look.track->seen.size() - 1, map.now_ns());
  if (!view) return false;
  view->undistorted_px += look.offset_px.cast<double>();
  seen.push_back({{camera.id, look.track->id}, *view});
  return position_of(map, seen, kLeastParallax_rad).has_value();
}

}  // namespace

void rebind_moving(ClassifyEdit& edit, const FrameSet& set, const FollowConfig& config, FollowReport* report) {
  const Map& map = edit.map();
  const std::vector<const MapPoint*> points = map.moving_points();
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = map.camera(cf.camera);
    if (!camera.frames.back().valid()) continue;
    const TrackGrid grid(camera, [](const ServerTrack& t) { return !t.bound() && t.moves() && t.patch; });
    for (const MapPoint* p : points) {
      if (p->map != camera.map || seen_by(*p, camera.id)) continue;
      const Look look = find_track(map, camera, grid, *p, config);
      if (look.track == nullptr || look.track->bound()) continue;
      if (!agrees(map, camera, *p, look)) continue;
      edit.bind_moving(*p, camera.id, *look.track, look.offset_px, Why::kLooksLikeIt, {look.zncc, 0});
      ++report->bound;
    }
  }
}

}  // namespace coslam
