// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/pose/pose_tracker.h"

#include <algorithm>

namespace coslam {
namespace {
constexpr std::size_t kHistory = 64;
// From which on a pose stands by itself; of the image.
}  // namespace

PoseTracker::PoseTracker(const CameraModel& camera, const PoseTrackerConfig& config)
    : camera_(camera), config_(config), own_map_(camera) {}

PoseTracker::KnownPoints PoseTracker::known_points(const std::vector<TrackObservation>& tracks,
                                                   const LocalMap& map) const {
  KnownPoints out;
  for (const TrackObservation& t : tracks) {
    const LocalMap::Entry* e = map.find(t.track);
    const Eigen::Vector2d px = t.undistorted_px.cast<double>();
    if (e != nullptr && (e->state == PointState::kStatic || e->is_direction())) {
      out.observations.push_back({e->position, e->covariance, px, e->is_direction()});
      out.from_server.push_back(!e->is_direction() && !e->former);
    } else if (const auto own_point = alone_ && e == nullptr ? own_map_.find(t.track) : std::nullopt) {
      out.observations.push_back({own_point->position, own_point->covariance, px});
      out.from_server.push_back(false);
    }
  }
  return out;
}

void PoseTracker::step(FrameId frame, TimeNs capture_ns, const std::vector<TrackObservation>& tracks,
                       const LocalMap& map, bool alone) {
  if (past_.empty()) {
    result_ = {};
    return;  // never placed, or lost and waiting for the server
  }
  alone_ = alone || (alone_ && told_agree_ < kFirmPoints);
  const auto [observations, from_server] = known_points(tracks, map);
  PoseRefinementConfig refinement{.sigma_px = camera_.px_from_640(config_.sigma_px)};
  const Rigid3& last = past_.back().cam_from_world;
  const auto dt_s = steady_s(capture_ns);
  if (dt_s) refinement.prior = motion_.predict(last, *dt_s);
  result_ = refine_pose(camera_, observations, dt_s ? motion_.expected(last, *dt_s) : last, refinement);

  const bool good = result_.status == PoseStatus::kOk && result_.inliers >= config_.min_inliers &&
                    result_.inliers >= config_.min_inlier_ratio * static_cast<double>(observations.size());
  told_agree_ = 0;
  if (!good) {
    state_ = PoseState::kLost;
    hull_ = 0;
    return;
  }
  std::vector<Eigen::Vector2d> inliers;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!result_.is_inlier[i]) continue;
    inliers.push_back(observations[i].undistorted_px);
    told_agree_ += !alone && from_server[i];
  }
  hull_ = hull_fraction(std::move(inliers), camera_);
  if (state_ == PoseState::kLost) past_.clear();  // the motion across the gap is unknown
  follow(capture_ns);
  state_ = PoseState::kTracked;
  own_map_.observe(result_.cam_from_world, tracks);
  past_.push_back({frame, capture_ns, result_.cam_from_world});
  if (past_.size() > kHistory) past_.pop_front();
}

std::optional<double> PoseTracker::steady_s(TimeNs capture_ns) const {
  if (state_ == PoseState::kLost || past_.empty() || !past_.back().capture_ns) return std::nullopt;
  const double dt_s = to_seconds(capture_ns - *past_.back().capture_ns);
  return dt_s > 0 && dt_s < SteadyMotion::kLongestGap_s ? std::optional(dt_s) : std::nullopt;
}

void PoseTracker::follow(TimeNs capture_ns) {
  const auto dt_s = steady_s(capture_ns);
  if (!dt_s) {
    motion_.lose();
    return;
  }
  const bool firm = result_.inliers >= kFirmPoints && hull_ >= kFirmHull;
  motion_.follow(past_.back().cam_from_world, result_.cam_from_world, result_.covariance, *dt_s, firm);
}

void PoseTracker::rebase(const Similarity3& new_from_old) {
  for (Past& p : past_) p.cam_from_world = transform_world(p.cam_from_world, new_from_old);
  own_map_.move(new_from_old);
  motion_.rescale(new_from_old.scale);
}

void PoseTracker::place(const PlacedPose& placed) {
  const auto same = std::find_if(past_.begin(), past_.end(), [&](const Past& p) { return p.frame == placed.frame; });
  if (same != past_.end() && state_ == PoseState::kTracked) {
    // Rigid change of the world that moves that pose to the given one; the frames since keep their motion.
    const Rigid3 old_from_new = same->cam_from_world.inverse() * placed.cam_from_world;
    const Rigid3 thought = past_.back().cam_from_world;
    for (Past& p : past_) p.cam_from_world = p.cam_from_world * old_from_new;
    const TimeNs now_ns = past_.back().capture_ns.value_or(0);
    motion_.correct(local(thought, past_.back().cam_from_world),
                    to_seconds(now_ns - same->capture_ns.value_or(now_ns)));
    const Rigid3 new_from_old = old_from_new.inverse();
    own_map_.move({1.0, new_from_old.rotation, new_from_old.translation});
    return;
  }
  past_ = {{placed.frame, std::nullopt, placed.cam_from_world}};
  motion_.lose();
  own_map_.clear();
  if (state_ == PoseState::kNone) state_ = PoseState::kLost;  // placed, not yet tracked
}

void PoseTracker::reset() {
  past_.clear();
  own_map_.clear();
  motion_ = {};
  alone_ = false;
  state_ = PoseState::kNone;
  result_ = {};
  hull_ = 0;
}

}  // namespace coslam
