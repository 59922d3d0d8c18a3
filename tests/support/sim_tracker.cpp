// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/sim_tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace coslam::test {

SimTracker::SimTracker(const SimWorld& world, CameraPath path, const TrackingConfig& config, std::string name,
                       RunId run)
    : world_(world),
      path_(std::move(path)),
      config_(config),
      name_(std::move(name)),
      run_(run),
      camera_(sim_camera()),
      random_(run.value),
      birth_after_(static_cast<std::size_t>(world.size()), 0) {}

std::optional<Eigen::Vector2d> SimTracker::seen_at(const Rigid3& pose, int point, TimeNs t_ns) const {
  const Eigen::Vector3d in_cam = pose * world_.position(point, t_ns + clock_behind_ns_);
  if (in_cam.z() < 0.3 || in_cam.z() > config_.max_depth_m) return std::nullopt;
  const Eigen::Vector2d px = camera_.project(in_cam);
  if (!camera_.contains_raw(px, config_.border_px)) return std::nullopt;
  return px;
}

TrackFrame SimTracker::observe(FrameId frame, TimeNs t_ns) {
  TrackFrame out;
  out.agent = name_;
  out.agent_run = run_;
  out.frame = frame;
  out.capture_ns = t_ns;
  const Rigid3 pose = truth(t_ns);
  const double scale = pixel_scale(camera_);
  for (auto at = live_.begin(); at != live_.end();) {
    Live& l = at->second;
    const auto px = seen_at(pose, l.point, t_ns);
    l.offset_px += l.slide_px;
    if (!px || chance() < config_.ends) {
      birth_after_[static_cast<std::size_t>(l.point)] =
          frame.value + static_cast<std::uint32_t>(config_.rebirth_frames);
      track_of_.erase(l.point);
      at = live_.erase(at);
      continue;
    }
    Eigen::Vector2d seen = *px + l.offset_px + config_.noise_px * Eigen::Vector2d(gauss(), gauss());
    if (chance() < config_.outliers) {
      const double angle = 6.28 * chance(), off_px = 8 + 32 * chance();
      seen += off_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
    out.tracks.push_back({at->first, quantised_px(seen, scale)});
    ++at;
  }
  for (int p = 0; p < world_.size() && static_cast<int>(live_.size()) < config_.max_tracks; ++p) {
    if (track_of_.contains(p) || frame.value < birth_after_[static_cast<std::size_t>(p)]) continue;
    const auto px = seen_at(pose, p, t_ns);
    if (!px) continue;
    const TrackId id(next_track_++);
    live_[id] = {p};
    track_of_[p] = id;
    point_of_[id] = p;
    const Eigen::Vector2d noise = config_.noise_px * Eigen::Vector2d(gauss(), gauss());
    out.tracks.push_back({id, quantised_px(*px + noise, scale)});
  }
  return out;
}

std::optional<TagObservation> SimTracker::see(TagId tag, const std::array<Eigen::Vector3d, 4>& corners, TimeNs t_ns) {
  TagObservation out{tag, {}};
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d in_cam = truth(t_ns) * corners[k];
    if (in_cam.z() < 0.1) return std::nullopt;
    const Eigen::Vector2d px = camera_.project(in_cam) + config_.noise_px * Eigen::Vector2d(gauss(), gauss());
    if (!camera_.contains_raw(px, config_.border_px)) return std::nullopt;
    out.undistorted_px[k] = quantised_px(px, pixel_scale(camera_));
  }
  return out;
}

PatchReply SimTracker::cut(const TrackFrame& frame, const std::vector<TrackId>& wanted) {
  PatchReply reply{name_, run_, frame.frame, {}};
  for (const TrackId id : wanted) {
    const auto at = live_.find(id);
    if (at == live_.end()) continue;
    ImagePatch& patch = reply.patches.emplace_back();
    patch.track = id;
    const Patch grey =
        world_.patch(at->second.point, sim_camera(), truth(frame.capture_ns), frame.capture_ns + clock_behind_ns_);
    for (std::size_t i = 0; i < grey.size(); ++i) {
      patch.grey[i] = static_cast<std::uint8_t>(std::clamp(grey[i] + 8 * gauss(), 0.0, 255.0));
    }
    patch.grey = quantised_patch(patch.grey);
  }
  return reply;
}

DescriptorReply SimTracker::describe(const TrackFrame& frame) {
  DescriptorReply reply{name_, run_, frame.frame, {}, {}};
  for (const TrackObservation& o : frame.tracks) {
    reply.tracks.push_back(o.track);
    for (const std::uint8_t byte : world_.descriptor(live_.at(o.track).point)) {
      reply.descriptors.push_back(
          quantised_descriptor(static_cast<std::uint8_t>(std::clamp(byte + 6 * gauss(), 0.0, 255.0))));
    }
  }
  return reply;
}

Hello SimTracker::hello() const { return {name_, run_, kProtocolVersion, Pacing::kLockstep, 30, camera_}; }

int SimTracker::point_of(TrackId track) const {
  const auto at = point_of_.find(track);
  return at == point_of_.end() ? -1 : at->second;
}

std::optional<TrackId> SimTracker::track_of(int point) const {
  const auto at = track_of_.find(point);
  return at == track_of_.end() ? std::nullopt : std::optional(at->second);
}

void SimTracker::slide(TrackId track, const Eigen::Vector2d& px_per_frame) { live_.at(track).slide_px = px_per_frame; }

}  // namespace coslam::test
