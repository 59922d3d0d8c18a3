// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/stamp_lag.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "server/estimator/map/sighting.h"

namespace coslam {
namespace {

constexpr double kStep_s = 0.05;                   // between lags
constexpr double kToldFrom_s = 0.12;               // less is found and made up for by ClockOffsets
constexpr double kAgree_s = 0.08;                  // two searches that found one lag
constexpr double kAgain_s = 5, kMuchLater_s = 60;  // between searches of a pair; when its clocks were found to agree
constexpr std::size_t kMostRays = 24;              // of one image, the same tracks from image to image
constexpr std::size_t kLeastSights = 50;

std::uint32_t shuffled(TrackId track) { return static_cast<std::uint32_t>(track.value * 2654435761U); }

}  // namespace

StampLagReport StampLag::run(StampLagEdit& edit) {
  const Map& map = edit.map();
  if (!config.enabled) return {};
  for (const MapCamera& c : map.cameras()) {
    if (c.alive) {
      look(map, c);
    } else {
      sights_.erase(c.id);
    }
  }
  if (!search_ && !begin_search(map)) return {};
  const double lag_s = -config.most_s + kStep_s * static_cast<double>(search_->lags.size());
  search_->lags.push_back(lag_agreement(search_->first, search_->second, lag_s));
  return {lag_s + kStep_s > config.most_s && end_search(edit) ? 1 : 0};
}

void StampLag::look(const Map& map, const MapCamera& camera) {
  std::deque<Sight>& sights = sights_[camera.id];
  while (!sights.empty()) {
    const FramePose* f = camera.frame_at(sights.front().set);
    if (f != nullptr && f->capture_ns >= map.now_ns() - to_ns(config.memory_s)) break;
    sights.pop_front();
  }
  if (camera.frames.empty() || camera.frames.back().set != map.now() || !camera.frames.back().valid()) return;
  Sight sight{map.now(), {}};
  for (const auto& [id, t] : camera.tracks) {
    const MapPoint* p = map.find(t.point);
    if (t.seen.back().set != map.now() || !(p != nullptr ? p->moves() : t.moves())) continue;
    sight.rays.push_back({id, Eigen::Vector3d::Zero()});
  }
  if (sight.rays.size() < kLeastTracks) return;
  if (sight.rays.size() > kMostRays) {
    const auto order = [](const MovingSight::Ray& r) { return shuffled(r.track); };
    std::ranges::nth_element(sight.rays, sight.rays.begin() + kMostRays, {}, order);
    sight.rays.resize(kMostRays);
    std::ranges::sort(sight.rays, {}, &MovingSight::Ray::track);
  }
  for (MovingSight::Ray& ray : sight.rays) {
    const View view{&camera.model, Rigid3(), camera.tracks.at(ray.track).seen.back().undistorted_px.cast<double>()};
    ray.direction = world_ray(view);
  }
  sights.push_back(std::move(sight));
}

std::vector<MovingSight> StampLag::in_world(const Map& map, CameraId camera) const {
  const MapCamera& c = map.camera(camera);
  std::vector<MovingSight> out;
  for (const Sight& s : sights_.at(camera)) {
    const FramePose* f = c.frame_at(s.set);
    if (f == nullptr || f->map != c.map) continue;
    out.push_back({f->capture_ns, f->cam_from_world.center(), s.rays});
    const Eigen::Quaterniond world_from_cam = f->cam_from_world.rotation.conjugate();
    for (MovingSight::Ray& ray : out.back().rays) ray.direction = world_from_cam * ray.direction;
  }
  return out;
}

// How long a pair has waited for its search; what was found is confirmed first.
TimeNs StampLag::waited_ns(const Map& map, const Pair& pair) const {
  const auto at = known_.find(pair);
  if (at == known_.end()) return map.now_ns() + 1;
  const Known& known = at->second;
  const bool agree = known.lag_s && std::abs(*known.lag_s) < kToldFrom_s;
  if (known.lag_s && !agree && !known.reported) return std::numeric_limits<TimeNs>::max();
  return map.now_ns() - known.searched_ns - to_ns(agree || known.reported ? kMuchLater_s : kAgain_s);
}

bool StampLag::comparable(const Map& map, const Pair& pair) const {
  const MapCamera &first = map.camera(pair.first), &second = map.camera(pair.second);
  return sights_.at(pair.first).size() >= kLeastSights && sights_.at(pair.second).size() >= kLeastSights &&
         first.map == second.map && first.map != MapId();
}

bool StampLag::begin_search(const Map& map) {
  std::optional<Pair> chosen;
  TimeNs most_ns = 0;
  for (const auto& [a, sights_of_a] : sights_) {
    for (const auto& [b, sights_of_b] : sights_) {
      if (!(a < b) || !comparable(map, {a, b})) continue;
      const TimeNs waited = waited_ns(map, {a, b});
      if (waited <= most_ns) continue;
      most_ns = waited;
      chosen = {a, b};
    }
  }
  if (!chosen) return false;
  search_ = {*chosen, in_world(map, chosen->first), in_world(map, chosen->second), {}};
  return true;
}

// True when it tells something new.
bool StampLag::end_search(StampLagEdit& edit) {
  const Map& map = edit.map();
  const Pair pair = search_->pair;
  const std::optional<double> lag_s = best_lag_s(search_->lags);
  search_.reset();
  Known& known = known_[pair];
  known.searched_ns = map.now_ns();
  const std::optional<double> before = std::exchange(known.lag_s, lag_s);
  if (!lag_s || !before || std::abs(*lag_s - *before) > kAgree_s) return false;
  return note(edit, pair, *lag_s);
}

bool StampLag::note(StampLagEdit& edit, const Pair& pair, double lag_s) {
  Known& known = known_[pair];
  known.lag_s = lag_s;
  const bool off = std::abs(lag_s) >= kToldFrom_s;
  const bool is_new = off && !known.reported;
  known.reported = off;
  if (is_new) edit.note_misdated(edit.map().camera(pair.second), lag_s, pair.first);
  return is_new;
}

void StampLag::finish(StampLagEdit& edit) {
  constexpr int kMostPairs = 3;  // of a camera
  search_.reset();
  const Map& map = edit.map();
  if (!config.enabled) return;
  for (const auto& [b, sights_of_b] : sights_) {
    int tried = 0;
    for (auto a = sights_.begin(); a->first < b && tried < kMostPairs && !lag(b); ++a) {
      const Pair pair{a->first, b};
      if (!comparable(map, pair)) continue;
      ++tried;
      if (const auto lag_s = lag_at_end(in_world(map, pair.first), in_world(map, pair.second)))
        note(edit, pair, *lag_s);
    }
  }
}

std::optional<double> StampLag::lag_at_end(std::span<const MovingSight> first,
                                           std::span<const MovingSight> second) const {
  std::vector<LagAgreement> lags;
  const int steps = static_cast<int>(std::max(config.most_s, config.memory_s / 2) / kStep_s);
  for (int i = -steps; i <= steps; ++i) lags.push_back(lag_agreement(first, second, i * kStep_s));
  return best_lag_s(lags);
}

bool StampLag::Lag::is_off() const { return std::abs(lag_s) >= kToldFrom_s; }

std::optional<StampLag::Lag> StampLag::lag(CameraId camera) const {
  for (const bool reported : {true, false}) {
    for (const auto& [pair, known] : known_) {
      const bool agrees = known.lag_s && std::abs(*known.lag_s) < kToldFrom_s;
      if (pair.second == camera && (reported ? known.reported : agrees)) return Lag{*known.lag_s, pair.first};
    }
  }
  return std::nullopt;
}

void StampLag::forget(CameraId camera) {
  const auto takes_part = [&](const Pair& pair) { return pair.first == camera || pair.second == camera; };
  sights_.erase(camera);
  std::erase_if(known_, [&](const auto& entry) { return takes_part(entry.first); });
  if (search_ && takes_part(search_->pair)) search_.reset();
}

}  // namespace coslam
