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
      pixel_scale_(pixel_scale(camera_)),
      random_(run.value),
      birth_after_(static_cast<std::size_t>(world.size()), 0) {}

std::optional<Eigen::Vector2d> SimTracker::seen_at(int point) const {
  const Eigen::Vector3d in_cam = pose_ * world_.position(point, t_ns_ + clock_behind_ns_);
  if (in_cam.z() < 0.3 || in_cam.z() > config_.max_depth_m) return std::nullopt;
  const Eigen::Vector2d px = camera_.project(in_cam);
  if (!camera_.contains_raw(px, config_.border_px)) return std::nullopt;
  return px;
}

bool SimTracker::may_start(int point) const {
  return !track_of_.contains(point) && frame_.value >= birth_after_[static_cast<std::size_t>(point)];
}

void SimTracker::end(TrackId track) {
  const int point = live_.at(track).point;
  birth_after_[static_cast<std::size_t>(point)] = frame_.value + static_cast<std::uint32_t>(config_.rebirth_frames);
  track_of_.erase(point);
  live_.erase(track);
}

void SimTracker::start(int point, const Eigen::Vector2d& px) {
  const TrackId id(next_track_++);
  live_[id] = {point};
  track_of_[point] = id;
  point_of_[id] = point;
  const Eigen::Vector2d noise = config_.noise_px * Eigen::Vector2d(gauss(), gauss());
  tracks_.push_back({id, quantised_px(px + noise, pixel_scale_)});
}

void SimTracker::follow() {
  const std::vector<Track> before = std::exchange(tracks_, {});
  for (const Track& t : before) {
    Live& l = live_.at(t.id);
    const auto px = seen_at(l.point);
    l.offset_px += l.slide_px;
    if (!px || chance() < config_.ends) {
      end(t.id);
      continue;
    }
    Eigen::Vector2d seen = *px + l.offset_px + config_.noise_px * Eigen::Vector2d(gauss(), gauss());
    if (chance() < config_.outliers) {
      const double angle = 6.28 * chance(), off_px = 8 + 32 * chance();
      seen += off_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
    tracks_.push_back({t.id, quantised_px(seen, pixel_scale_), t.age_frames + 1});
  }
}

const std::vector<Track>& SimTracker::step(const Image& image) {
  frame_ = image.frame;
  t_ns_ = image.capture_ns;
  pose_ = truth(t_ns_);
  follow();
  for (int p = 0; p < world_.size() && static_cast<int>(live_.size()) < config_.max_tracks; ++p) {
    if (!may_start(p)) continue;
    if (const auto px = seen_at(p)) start(p, *px);
  }
  return tracks_;
}

void SimTracker::thin(int at_most) {
  for (; at_most > 0 && static_cast<int>(tracks_.size()) > config_.max_tracks; --at_most) {
    end(tracks_.back().id);
    tracks_.pop_back();
  }
}

std::vector<ImagePatch> SimTracker::patches(const std::vector<TrackId>& tracks) {
  std::vector<ImagePatch> out;
  for (const TrackId id : tracks) {
    const auto at = live_.find(id);
    if (at == live_.end()) continue;
    ImagePatch& patch = out.emplace_back();
    patch.track = id;
    const Patch grey = world_.patch(at->second.point, camera_, pose_, t_ns_ + clock_behind_ns_);
    for (std::size_t i = 0; i < grey.size(); ++i) {
      patch.grey[i] = static_cast<std::uint8_t>(std::clamp(grey[i] + 8 * gauss(), 0.0, 255.0));
    }
    patch.grey = quantised_patch(patch.grey);
  }
  return out;
}

DescribedTracks SimTracker::described(std::vector<TrackId> tracks) {
  std::ranges::sort(tracks);
  DescribedTracks out;
  out.tracks = std::move(tracks);
  for (const TrackId id : out.tracks) {
    for (const std::uint8_t byte : world_.descriptor(live_.at(id).point)) {
      out.descriptors.push_back(
          quantised_descriptor(static_cast<std::uint8_t>(std::clamp(byte + 6 * gauss(), 0.0, 255.0))));
    }
  }
  return out;
}

std::function<FeatureTracker::StartTracks()> SimTracker::describe_strongest(int most) {
  return [this, most] { return [this, most](int most_new) { return start_strongest(most, most_new); }; };
}

DescribedTracks SimTracker::start_strongest(int most, int most_new) {
  std::vector<TrackId> tracks;
  for (int p = 0; p < world_.size() && static_cast<int>(tracks.size()) < most; ++p) {
    if (most_new > 0 && may_start(p)) {
      if (const auto px = seen_at(p)) {
        start(p, *px);
        --most_new;
      }
    }
    if (const auto at = track_of_.find(p); at != track_of_.end()) tracks.push_back(at->second);
  }
  return described(std::move(tracks));
}

std::function<DescribedTracks()> SimTracker::describe_at(const std::vector<TrackId>& wanted, int most) {
  std::vector<TrackId> tracks;
  for (const auto& [point, track] : track_of_) {
    if (static_cast<int>(tracks.size()) == most) break;
    if (std::ranges::binary_search(wanted, track)) tracks.push_back(track);
  }
  return [all = described(std::move(tracks))] { return all; };
}

std::optional<TagObservation> SimTracker::see(TagId tag, const std::array<Eigen::Vector3d, 4>& corners) {
  TagObservation out{tag, {}};
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d in_cam = pose_ * corners[k];
    if (in_cam.z() < 0.1) return std::nullopt;
    const Eigen::Vector2d px = camera_.project(in_cam) + config_.noise_px * Eigen::Vector2d(gauss(), gauss());
    if (!camera_.contains_raw(px, config_.border_px)) return std::nullopt;
    out.undistorted_px[k] = quantised_px(px, pixel_scale_);
  }
  return out;
}

std::vector<TagObservation> SimTracker::tags() {
  std::vector<TagObservation> out;
  for (const auto& [tag, corners] : tags_) {
    if (const auto seen = see(tag, corners)) out.push_back(*seen);
  }
  return out;
}

TrackFrame SimTracker::observe(FrameId frame, TimeNs t_ns) {
  TrackFrame out;
  out.agent = name_;
  out.agent_run = run_;
  out.frame = frame;
  out.capture_ns = t_ns;
  for (const Track& t : step({frame, t_ns, {}})) out.tracks.push_back({t.id, t.raw_px});
  return out;
}

PatchReply SimTracker::cut(const TrackFrame& frame, const std::vector<TrackId>& wanted) {
  return {name_, run_, frame.frame, patches(wanted)};
}

DescriptorReply SimTracker::describe(const TrackFrame& frame) {
  std::vector<TrackId> all;
  all.reserve(frame.tracks.size());
  for (const TrackObservation& o : frame.tracks) all.push_back(o.track);
  DescribedTracks d = described(std::move(all));
  return {name_, run_, frame.frame, std::move(d.tracks), std::move(d.descriptors)};
}

CameraModel TrackingConfig::calibration() const {
  CameraModel camera = sim_camera();
  camera.fx *= 1 + focal_error;
  camera.fy *= 1 + focal_error;
  return camera;
}

Hello SimTracker::hello() const {
  return {name_, run_, kProtocolVersion, Pacing::kLockstep, 30, config_.calibration()};
}

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
