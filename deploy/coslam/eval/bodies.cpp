// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/bodies.h"

#include <algorithm>
#include <cmath>

#include "deploy/coslam/eval/statistics.h"
#include "deploy/simulation/scene.h"

namespace coslam::eval {
namespace {

constexpr int kMinCameras = 2;
constexpr int kFewTracks = 3, kManyTracks = 12;  // of each of these cameras
constexpr TimeNs kClockSlack_ns = 1'000'000;     // written times are rounded

std::optional<double> share(int part, int whole) {
  return whole == 0 ? std::nullopt : std::optional(static_cast<double>(part) / whole);
}

// Entry of the time that is nearest to t_ns, at most reach_ns away.
template <class Map>
typename Map::const_iterator nearest(const Map& by_time, TimeNs t_ns, TimeNs reach_ns) {
  auto best = by_time.end();
  for (auto i = by_time.lower_bound(t_ns - reach_ns); i != by_time.end() && i->first <= t_ns + reach_ns; ++i) {
    if (best == by_time.end() || std::abs(i->first - t_ns) < std::abs(best->first - t_ns)) best = i;
  }
  return best;
}

}  // namespace

std::optional<double> BodyScore::coverage() const { return share(covered, instants); }
std::optional<double> BodyScore::object_found() const { return share(objects_found, object_instants); }
std::optional<double> BodyScore::velocity_error_m_s() const {
  return velocity_errors_m_s.empty() ? std::nullopt : std::optional(percentile(velocity_errors_m_s, 50));
}

BodyScore& BodyScore::operator+=(const BodyScore& other) {
  instants += other.instants;
  covered += other.covered;
  object_instants += other.object_instants;
  objects_found += other.objects_found;
  velocity_errors_m_s.insert(velocity_errors_m_s.end(), other.velocity_errors_m_s.begin(),
                             other.velocity_errors_m_s.end());
  return *this;
}

BodyScore sum_of(const std::map<std::string, BodyScore>& bodies) {
  BodyScore sum;
  for (const auto& [name, score] : bodies) sum += score;
  return sum;
}

void BodyTracks::add(const std::string& agent, const ResultTrackRow& row, const SurfacePoint& seen) {
  if (row.point != PointId()) ++seen_on_[row.point][seen.body];
  if (seen.body.empty() || seen.velocity_m_s.norm() <= kMovingSpeed_m_s) return;
  Instant& instant = bodies_[seen.body][row.t_ns];
  ++instant.tracks[agent];
  instant.velocity_m_s = seen.body_velocity_m_s;
}

std::unordered_map<PointId, std::string> BodyTracks::bodies_of_points() const {
  std::unordered_map<PointId, std::string> out;
  for (const auto& [point, counts] : seen_on_) {
    const auto most = std::max_element(counts.begin(), counts.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (!most->first.empty()) out.emplace(point, most->first);
  }
  return out;
}

std::map<std::string, BodyScore> BodyTracks::scores(const std::unordered_map<PointId, PointPath>& dynamic,
                                                    const std::optional<ObjectsAt>& objects,
                                                    const Similarity3& truth_from_map, TimeNs frame_ns) const {
  const TimeNs reach_ns = frame_ns + kClockSlack_ns;
  const auto body_of = bodies_of_points();
  std::map<std::string, std::map<TimeNs, int>> samples;
  for (const auto& [point, path] : dynamic) {
    const auto body = body_of.find(point);
    if (body == body_of.end()) continue;
    for (const StampedPosition& sample : path) ++samples[body->second][sample.t_ns];
  }
  const auto mostly_on = [&](const ResultObjectRow& object, const std::string& body) {
    const auto on = std::count_if(object.members.begin(), object.members.end(), [&](PointId member) {
      const auto at = body_of.find(member);
      return at != body_of.end() && at->second == body;
    });
    return 2 * on > static_cast<std::ptrdiff_t>(object.members.size());
  };

  std::map<std::string, BodyScore> out;
  for (const auto& [body, instants] : bodies_) {
    BodyScore& score = out[body];
    for (const auto& [t_ns, instant] : instants) {
      const auto cameras_with = [&counts = instant.tracks](int tracks) {
        return std::count_if(counts.begin(), counts.end(), [&](const auto& c) { return c.second >= tracks; });
      };
      if (cameras_with(kFewTracks) >= kMinCameras) {
        ++score.instants;
        score.covered += nearest(samples[body], t_ns, reach_ns) != samples[body].end() ? 1 : 0;
      }
      if (!objects || cameras_with(kManyTracks) < kMinCameras) continue;
      ++score.object_instants;
      const auto written = nearest(*objects, t_ns, reach_ns);
      if (written == objects->end()) continue;
      std::vector<const ResultObjectRow*> on_body;
      for (const ResultObjectRow& object : written->second) {
        if (mostly_on(object, body)) on_body.push_back(&object);
      }
      if (on_body.size() != 1) continue;
      ++score.objects_found;
      const Eigen::Vector3d velocity_m_s =
          truth_from_map.scale * (truth_from_map.rotation * on_body[0]->velocity_per_s);
      score.velocity_errors_m_s.push_back((velocity_m_s - instant.velocity_m_s).norm());
    }
  }
  return out;
}

ObjectsAt read_objects(const std::filesystem::path& file) {
  ObjectsAt out;
  for_each_object_row(file, [&](const ResultObjectRow& row) { out[row.t_ns].push_back(row); });
  return out;
}

}  // namespace coslam::eval
