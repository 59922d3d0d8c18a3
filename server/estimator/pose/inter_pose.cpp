// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/pose/inter_pose.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <vector>

#include "common/geometry/pose_refinement.h"
#include "common/geometry/triangulation.h"
#include "server/estimator/map/sighting.h"
#include "server/estimator/solve/inter_pose.h"

namespace coslam {
namespace {

struct Member {
  const CameraFrame* frame;
  const MapCamera* camera;
  std::vector<PointObservation> statics;
  int moving = 0;
  bool weak = false;
  std::optional<Matrix6d> covariance{};  // of the pose that was found together
};

bool weak(const Member& m) {
  if (!m.camera->frames.back().valid() || m.moving > static_cast<int>(m.statics.size())) return true;
  std::vector<Eigen::Vector2d> pixels;
  for (const PointObservation& o : m.statics) pixels.push_back(o.undistorted_px);
  return hull_fraction(pixels, m.camera->model) < kFirmHull;
}

Member look_at(const Map& map, const CameraFrame& cf) {
  Member m{.frame = &cf, .camera = &map.camera(cf.camera)};
  for (const auto& [id, track] : m.camera->tracks) {
    const MapPoint* p = map.find(track.point);
    if (p == nullptr || p->map != m.camera->map) continue;
    if (p->moves()) ++m.moving;
    if (!p->proven() && !(p->rests() && m.camera->sparse)) continue;
    if (track.gate_failures > 0) continue;
    m.statics.push_back({p->position, p->covariance, track.seen.back().undistorted_px.cast<double>()});
  }
  m.weak = weak(m);
  return m;
}

// The newest observation of a moving point as the camera would have made it from this pose of its newest frame had it
// taken the image at the instant of the set. What the point's own motion since the frame before says; that of the
// camera is left out.
Eigen::Vector2d at_instant(const Map& map, const MapCamera& c, const ServerTrack& t, const MapPoint& p,
                           const Rigid3& pose) {
  const Sighting seen = sighting(c, t, t.seen.size() - 1);
  Eigen::Vector2d px = seen.undistorted_px.cast<double>();
  if (c.frames.size() < 2) return px;
  const FramePose &now = c.frames.back(), &before = c.frames[c.frames.size() - 2];
  const TimeNs later_ns = map.now_ns() - c.taken_ns(now), period_ns = now.capture_ns - before.capture_ns;
  Eigen::Vector2d now_px, before_px;
  if (later_ns == 0 || std::abs(later_ns) > period_ns || before.map != p.map || seen.step_px.isZero() ||
      !project_world(c.model, pose, p.position, &now_px) ||
      !project_world(c.model, before.cam_from_world, p.position, &before_px))
    return px;
  const Eigen::Vector2d own_px = seen.step_px.cast<double>() - (now_px - before_px);
  return px + static_cast<double>(later_ns) / static_cast<double>(period_ns) * own_px;
}

// Moving points that at least two of the members see now.
std::vector<InterPoseProblem::MovingPoint> shared_moving(const Map& map, const std::vector<Member>& members,
                                                         const std::vector<Rigid3>& poses) {
  std::map<CameraId, int> index;
  for (std::size_t i = 0; i < members.size(); ++i) index[members[i].camera->id] = static_cast<int>(i);
  std::vector<InterPoseProblem::MovingPoint> out;
  for (const MapPoint* moving : map.moving_points()) {
    const MapPoint& p = *moving;
    InterPoseProblem::MovingPoint m{p.position, {}};
    std::vector<View> views;
    for (const BoundTrack& b : p.bound) {
      const auto at = index.find(b.camera);
      if (at == index.end()) continue;
      const MapCamera& c = map.camera(b.camera);
      const ServerTrack& t = c.tracks.at(b.track);
      const Rigid3& pose = poses[static_cast<std::size_t>(at->second)];
      const Eigen::Vector2d px = at_instant(map, c, t, p, pose);
      m.seen.emplace_back(at->second, px);
      views.push_back({&c.model, pose, px});
    }
    if (m.seen.size() < 2) continue;
    const TriangulationResult t = triangulate(views, 1.0, 0.0);
    if (t.status == TriangulationStatus::kOk) m.position = t.position;
    out.push_back(std::move(m));
  }
  return out;
}

// Moving points that a camera shares with others.
int shares(const InterPoseProblem& problem, int camera) {
  return static_cast<int>(std::count_if(problem.moving.begin(), problem.moving.end(), [&](const auto& m) {
    return std::any_of(m.seen.begin(), m.seen.end(), [&](const auto& seen) { return seen.first == camera; });
  }));
}

// The frame before the newest, to follow a camera's motion from; null where there is none, or a gap.
const FramePose* before_newest(const MapCamera& c) {
  if (c.frames.size() < 2) return nullptr;
  const FramePose &now = c.frames.back(), &before = c.frames[c.frames.size() - 2];
  const double dt_s = to_seconds(now.capture_ns - before.capture_ns);
  return before.valid() && before.map == c.map && dt_s > 0 && dt_s < SteadyMotion::kLongestGap_s ? &before : nullptr;
}

using Motions = std::map<CameraId, SteadyMotion>;

std::optional<PosePrior> prior_of(const MapCamera& c, const Motions& motions) {
  const FramePose* before = before_newest(c);
  const auto at = motions.find(c.id);
  if (before == nullptr || at == motions.end()) return std::nullopt;
  return at->second.predict(before->cam_from_world, to_seconds(c.frames.back().capture_ns - before->capture_ns));
}

void follow(const Member& m, Motions* motions) {
  SteadyMotion& motion = (*motions)[m.camera->id];
  const FramePose* before = before_newest(*m.camera);
  const FramePose& now = m.camera->frames.back();
  if (before == nullptr || !now.valid() || (m.weak && !m.covariance)) {
    motion.lose();
    return;
  }
  motion.follow(before->cam_from_world, now.cam_from_world, m.weak ? *m.covariance : Matrix6d::Zero(),
                to_seconds(now.capture_ns - before->capture_ns), !m.weak);
}

void solve_group(InterPoseEdit& edit, std::vector<Member>& members, const InterPoseConfig& config, int min_inliers,
                 const Motions& motions, InterPoseReport* report) {
  const Map& map = edit.map();
  InterPoseProblem problem;
  std::vector<Rigid3> poses;
  for (Member& m : members) {
    const FramePose& f = m.camera->frames.back();
    poses.push_back(f.valid() ? f.cam_from_world : start_pose(map, *m.camera, m.frame->frame));
    problem.cameras.push_back({&m.camera->model, poses.back(), std::max(kLeastSigma_px, m.camera->sigma_px), m.statics,
                               m.weak ? prior_of(*m.camera, motions) : std::nullopt});
  }
  problem.moving = shared_moving(map, members, poses);
  if (static_cast<int>(problem.moving.size()) < config.min_moving) return;
  ++report->calls;
  const InterPoseResult result = solve_inter_pose(problem);
  if (!result.ok) return;
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (result.cameras[i].inliers < min_inliers) continue;
    report->rescued += !members[i].camera->frames.back().valid();
    ++report->posed;
    members[i].covariance = result.cameras[i].covariance;
    const bool joint = members[i].weak && shares(problem, static_cast<int>(i)) >= config.min_moving;
    edit.set_joint_pose(*members[i].camera, result.cameras[i].cam_from_world, joint);
  }
}

}  // namespace

InterPoseReport inter_pose(InterPoseEdit& edit, const FrameSet& set, const ViewGraph& graph,
                           const InterPoseConfig& config, const LocaliseConfig& localise, Motions* motions) {
  const Map& map = edit.map();
  InterPoseReport report;
  if (!config.enabled) return report;
  for (const auto& group : graph.groups) {
    std::vector<Member> members;
    for (const CameraFrame& cf : set.frames) {
      const bool in = std::find(group.begin(), group.end(), cf.camera) != group.end();
      if (in && map.camera(cf.camera).map != MapId()) members.push_back(look_at(map, cf));
    }
    const bool same_map =
        std::ranges::all_of(members, [&](const Member& m) { return m.camera->map == members[0].camera->map; });
    if (members.size() > 1 && same_map && std::ranges::any_of(members, &Member::weak)) {
      solve_group(edit, members, config, localise.min_inliers, *motions, &report);
    }
    for (const Member& m : members) follow(m, motions);
  }
  return report;
}

}  // namespace coslam
