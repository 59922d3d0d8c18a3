// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/clock_offsets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "server/estimator/map/sighting.h"

namespace coslam {
namespace {

// Sets before and after an instant that tell the speed there: near ones, which follow every turn, and ones farther away
// as instruments, which noise matters less for.
constexpr std::uint32_t kNear = 1, kFar = 3;
constexpr std::size_t kStretch =
    30;  // observations whose shift is one; twice as far back two tracks that were found to be one point are looked at
constexpr std::size_t kMostOfPair = 200;  // stretches for each pair of cameras, so that time stays bounded
constexpr double kPrior_s = 0.02;
constexpr double kPoseShare = 0.1;       // of a residual's variance that comes from the poses: all points have it alike
constexpr std::size_t kMostShared = 10;  // pairs of tracks of two cameras at one instant that are looked at
constexpr double kSystematic_s = 0.001;  // error that no number of observations takes away
constexpr double kLeastClockSigma_px = 0.35;  // at 640 px image width

// Distance of the two rays' planes through the baseline, as pixels of one camera: its noise is that of the pixels.
// Empty near the epipoles.
std::optional<double> epipolar_px(const View& a, const View& b) {
  const Eigen::Vector3d baseline = (b.cam_from_world.center() - a.cam_from_world.center()).normalized();
  const Eigen::Vector3d ray_a = world_ray(a), ray_b = world_ray(b);
  const double sines2 = ray_a.cross(baseline).squaredNorm() + ray_b.cross(baseline).squaredNorm();
  if (!(sines2 > 0.05)) return std::nullopt;
  return a.camera->focal_px() * baseline.dot(ray_a.cross(ray_b)) / std::sqrt(sines2);
}

// A track around one set.
struct Moment {
  View at;
  struct Beside {
    View before, after;
    double span_s = 0;
  } near, far;
};

std::optional<Moment::Beside> beside(const MapCamera& c, const ServerTrack& t, std::size_t i, std::uint32_t sets) {
  const auto as_taken = [&](std::size_t k) -> std::optional<View> {
    const FramePose* f = c.frame_at(t.seen[k].set);
    if (f == nullptr || f->map != c.map) return std::nullopt;
    return View{&c.model, f->cam_from_world, (t.seen[k].undistorted_px + t.offset_px).cast<double>()};
  };
  const auto before = as_taken(i - sets), after = as_taken(i + sets);
  if (!before || !after || t.seen[i + sets].set.value - t.seen[i - sets].set.value != 2 * sets) return std::nullopt;
  const TimeNs span_ns = c.frame_at(t.seen[i + sets].set)->capture_ns - c.frame_at(t.seen[i - sets].set)->capture_ns;
  return Moment::Beside{*before, *after, to_seconds(span_ns)};
}

std::optional<Moment> moment(const MapCamera& c, const ServerTrack& t, SetId set, TimeNs t_ns) {
  const auto at = t.index_at(set);
  if (!at || *at < kFar || t.seen.size() - *at <= kFar) return std::nullopt;
  const std::size_t i = *at;
  if (t.seen[i - kFar].set.value < t.distrusted_before) return std::nullopt;
  const auto view = view_at(c, t, i, t_ns);
  const auto near = beside(c, t, i, kNear), far = beside(c, t, i, kFar);
  if (!view || !near || !far) return std::nullopt;
  return Moment{*view, *near, *far};
}

// How fast the residual changes with the stamp of one of the two.
std::optional<double> rate_px_s(const Moment::Beside& moved, auto&& residual_px) {
  const auto before = residual_px(moved.before), after = residual_px(moved.after);
  if (!before || !after) return std::nullopt;
  return (*after - *before) / moved.span_s;
}

std::optional<ClockObservation> observation(const MapCamera& a, const ServerTrack& in_a, const MapCamera& b,
                                            const ServerTrack& in_b, SetId set) {
  const FramePose *at_a = a.frame_at(set), *at_b = b.frame_at(set);
  if (at_a == nullptr || at_b == nullptr || at_a->joint || at_b->joint) return std::nullopt;
  const TimeNs t_ns = a.taken_ns(*at_a) / 2 + b.taken_ns(*at_b) / 2;
  const auto first = moment(a, in_a, set, t_ns), second = moment(b, in_b, set, t_ns);
  if (!first || !second) return std::nullopt;
  const auto of_first = [&](const View& v) { return epipolar_px(v, second->at); };
  const auto of_second = [&](const View& v) { return epipolar_px(first->at, v); };
  const auto now = epipolar_px(first->at, second->at), first_near = rate_px_s(first->near, of_first),
             second_near = rate_px_s(second->near, of_second), first_far = rate_px_s(first->far, of_first),
             second_far = rate_px_s(second->far, of_second);
  if (!now || !first_near || !second_near || !first_far || !second_far) return std::nullopt;
  ClockObservation o{*now, {*first_near, *second_near}, {*first_far, *second_far}};
  // The offsets in use were taken into account; the residual is to be that of the stamps.
  o.residual_px += o.rates_px_s.dot(Eigen::Vector2d(to_seconds(a.clock_offset_ns), to_seconds(b.clock_offset_ns)));
  return o;
}

}  // namespace

ClockOffsetsReport ClockOffsets::run(ClockOffsetsEdit& edit) {
  const Map& map = edit.map();
  if (!config.enabled) return {};
  offsets_.resize(map.cameras().size(), {0, kPrior_s});
  struct Shared {
    const MapPoint* point = nullptr;
    BoundTrack first, second;
  };
  std::map<std::pair<CameraId, CameraId>, std::vector<Shared>> shared;
  for (const MapPoint* p : map.moving_points()) {
    for (const BoundTrack& first : p->bound) {
      for (const BoundTrack& second : p->bound) {
        if (first.camera < second.camera) shared[{first.camera, second.camera}].push_back({p, first, second});
      }
    }
  }
  for (auto& [cameras, all] : shared) {
    if (all.size() > kMostShared) {
      const auto order = [](const Shared& s) { return s.point->id.value * 2654435761U; };  // any, but of all bodies
      std::nth_element(all.begin(), all.begin() + kMostShared, all.end(),
                       [&](const Shared& x, const Shared& y) { return order(x) < order(y); });
      all.resize(kMostShared);
    }
    const double weight = 1 / (1 + kPoseShare * (static_cast<double>(all.size()) - 1));
    for (const Shared& s : all) observe(map, *s.point, s.first, s.second, weight);
  }
  close(map);
  const bool due = map.every(config.period_s);
  if (due) estimate(edit);
  return {due};
}

void ClockOffsets::observe(const Map& map, const MapPoint& point, const BoundTrack& first, const BoundTrack& second,
                           double weight) {
  const MapCamera &a = map.camera(first.camera), &b = map.camera(second.camera);
  if (a.map != point.map || b.map != point.map || map.now().value < kFar) return;
  const std::uint32_t last = map.now().value - kFar;
  const Pair pair{first.camera, first.track, second.camera, second.track};
  std::uint32_t& next = next_.try_emplace(pair, last - std::min(last, std::uint32_t{2 * kStretch})).first->second;
  for (; next <= last; ++next) {
    auto o = observation(a, a.tracks.at(first.track), b, b.tracks.at(second.track), SetId(next));
    if (!o) continue;
    o->weight = weight;
    Stretch& s = open_.try_emplace(pair, Stretch{pair, 0, {}}).first->second;
    if (s.seen.seen.empty()) {
      const double least_px = a.model.px_from_640(kLeastClockSigma_px);
      s.seen.first = first.camera.value;
      s.seen.second = second.camera.value;
      s.seen.sigma_px = std::max({least_px, a.sigma_px, b.sigma_px});
    }
    s.last_ns = map.now_ns();
    s.seen.seen.push_back(*o);
    if (s.seen.seen.size() < kStretch) continue;
    stretches_.push_back(std::move(s));
    open_.erase(pair);
  }
}

// Pairs of tracks that are no more one point, or ended.
void ClockOffsets::close(const Map& map) {
  const auto live = [&](const Pair& pair) {
    const auto& [camera_a, track_a, camera_b, track_b] = pair;
    const auto &in_a = map.camera(camera_a).tracks, &in_b = map.camera(camera_b).tracks;
    const auto a = in_a.find(track_a), b = in_b.find(track_b);
    return a != in_a.end() && b != in_b.end();
  };
  std::erase_if(open_, [&](auto& entry) {
    if (live(entry.first)) return false;
    stretches_.push_back(std::move(entry.second));
    return true;
  });
  std::erase_if(next_, [&](const auto& entry) { return !live(entry.first); });
  const TimeNs since_ns = map.now_ns() - to_ns(config.memory_s);
  std::erase_if(stretches_, [&](const Stretch& s) { return s.last_ns < since_ns; });
  const std::size_t most = kMostOfPair * map.cameras().size() * (map.cameras().size() - 1) / 2;
  while (stretches_.size() > most) stretches_.pop_front();
}

void ClockOffsets::estimate(ClockOffsetsEdit& edit) {
  const Map& map = edit.map();
  std::vector<ClockStretch> all;
  for (const Stretch& s : stretches_) all.push_back(s.seen);
  for (const auto& [pair, s] : open_) all.push_back(s.seen);
  if (all.empty()) return;
  offsets_ = solve_clock_offsets(static_cast<int>(map.cameras().size()), all, kPrior_s);
  for (const MapCamera& c : map.cameras()) {
    const ClockOffset& o = offsets_[c.id.value];
    const double sigma_s = std::hypot(o.sigma_s, kSystematic_s);
    const bool known = std::abs(o.offset_s) > config.significance * sigma_s;
    edit.set_clock_offset(c, known ? to_ns(o.offset_s) : 0);
  }
}

void ClockOffsets::forget(CameraId camera) {
  const auto takes_part = [&](const Pair& pair) { return std::get<0>(pair) == camera || std::get<2>(pair) == camera; };
  std::erase_if(open_, [&](const auto& entry) { return takes_part(entry.first); });
  std::erase_if(next_, [&](const auto& entry) { return takes_part(entry.first); });
  std::erase_if(stretches_, [&](const Stretch& s) { return takes_part(s.pair); });
  if (camera.value < offsets_.size()) offsets_[camera.value] = {0, kPrior_s};
}

ClockOffset ClockOffsets::offset(CameraId camera) const {
  return camera.value < offsets_.size() ? offsets_[camera.value] : ClockOffset{0, kPrior_s};
}

}  // namespace coslam
