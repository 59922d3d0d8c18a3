// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/tracker.h"

#include <algorithm>
#include <optional>

#include "agent/track/align.h"
#include "agent/track/corners.h"
#include "agent/track/motion.h"
#include "agent/track/pyramid.h"
#include "common/base/check.h"

namespace coslam {

struct Tracker::State {
  explicit State(const TrackerConfig& c) : config(c) {}

  TrackerConfig config;
  Pyramid previous, current;
  std::vector<Track> tracks;
  std::vector<Eigen::Vector2f> velocity_px;  // motion of each track from the image before the previous
  Eigen::Vector2f shift_px = Eigen::Vector2f::Zero();
  std::optional<CornerFinder> finder;
  std::uint32_t next_id = 1;

  void follow();
  bool follow_one(const Track& track, const Eigen::Vector2f& guess_px, Eigen::Vector2f& px) const;
  bool inside(const Eigen::Vector2f& px) const;
  void replenish();
};

bool Tracker::State::inside(const Eigen::Vector2f& px) const {
  const float border = static_cast<float>(config.border_px);
  return px.x() >= border && px.y() >= border && px.x() <= static_cast<float>(current.level(0).cols() - 1) - border &&
         px.y() <= static_cast<float>(current.level(0).rows() - 1) - border;
}

bool Tracker::State::follow_one(const Track& track, const Eigen::Vector2f& guess_px, Eigen::Vector2f& px) const {
  const Alignment forward = align(previous, track.raw_px, current, guess_px, {current.levels() - 1, 0});
  if (!forward.found || !inside(forward.px) || forward.zncc < config.min_zncc) return false;
  const Alignment back = align(current, forward.px, previous, track.raw_px, {1, 0});
  if (!back.found || (back.px - track.raw_px).norm() > config.forward_backward_px) return false;
  px = forward.px;
  return true;
}

void Tracker::State::follow() {
  if (tracks.empty()) return;
  const Eigen::Vector2f shift = global_shift(previous, current);
  const Eigen::Vector2f change = shift - shift_px;
  shift_px = shift;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Track track = tracks[i];
    const Eigen::Vector2f motion = track.age_frames > 0 ? Eigen::Vector2f(velocity_px[i] + change) : shift;
    Eigen::Vector2f px;
    if (!follow_one(track, track.raw_px + motion, px)) continue;
    velocity_px[kept] = px - track.raw_px;
    tracks[kept++] = {track.id, px, track.age_frames + 1};
  }
  tracks.resize(kept);
  velocity_px.resize(kept);
}

void Tracker::State::replenish() {
  const int missing = config.max_tracks - static_cast<int>(tracks.size());
  if (missing <= 0) return;
  if (!finder) {
    CornerConfig c;
    c.max_tracks = config.max_tracks;
    c.min_distance_px = static_cast<float>(config.min_distance_px * current.level(0).cols() / 640.0);
    c.min_eigenvalue = static_cast<float>(config.min_eigenvalue);
    c.border_px = static_cast<float>(config.border_px) + 4;
    finder.emplace(c);
  }
  std::vector<Eigen::Vector2f> live;
  for (const Track& t : tracks) live.push_back(t.raw_px);
  for (const Eigen::Vector2f& px : finder->find(current.level(0), live, missing)) {
    tracks.push_back({TrackId(next_id++), px, 0});
    velocity_px.emplace_back(0, 0);
  }
}

Tracker::Tracker(const TrackerConfig& config) : state_(std::make_unique<State>(config)) {}
Tracker::~Tracker() = default;

const std::vector<Track>& Tracker::step(const cv::Mat& grey) {
  COSLAM_CHECK(grey.type() == CV_8UC1, "a grey 8-bit image");
  std::swap(state_->previous, state_->current);
  state_->current.build(grey, state_->config.levels);
  state_->follow();
  state_->replenish();
  return state_->tracks;
}

const std::vector<Track>& Tracker::live() const { return state_->tracks; }

std::vector<TrackId> Tracker::add(const std::vector<Eigen::Vector2f>& raw_px, float same_px) {
  std::vector<TrackId> ids;
  for (const Eigen::Vector2f& px : raw_px) {
    const auto same = std::find_if(state_->tracks.begin(), state_->tracks.end(),
                                   [&](const Track& t) { return (t.raw_px - px).squaredNorm() < same_px * same_px; });
    if (same != state_->tracks.end()) {
      ids.push_back(same->id);
      continue;
    }
    ids.push_back(TrackId(state_->next_id++));
    state_->tracks.push_back({ids.back(), px, 0});
    state_->velocity_px.emplace_back(0, 0);
  }
  return ids;
}

void Tracker::reset() {
  state_->tracks.clear();
  state_->velocity_px.clear();
  state_->shift_px.setZero();
}

}  // namespace coslam
