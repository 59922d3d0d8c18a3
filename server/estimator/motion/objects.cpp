// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/objects.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "server/estimator/motion/objects_joining.h"

namespace coslam {
namespace {

double mean_distance(const Map& map, const MapPoint& p) {
  double sum = 0;
  int n = 0;
  for (const BoundTrack& b : p.bound) {
    const FramePose& f = map.camera(b.camera).frames.back();
    if (!f.valid() || f.map != p.map) continue;
    sum += (f.cam_from_world.center() - p.position).norm();
    ++n;
  }
  return n == 0 ? 0 : sum / n;
}

Eigen::Vector3d drift_of(const MovingPath& path) {
  const std::size_t third = std::max<std::size_t>(1, path.size() / 3);
  Eigen::Vector3d way = Eigen::Vector3d::Zero();
  double time_s = 0;
  for (std::size_t i = 0; i < third; ++i) {
    const PathSample &late = path[path.size() - 1 - i], &early = path[third - 1 - i];
    way += late.position - early.position;
    time_s += to_seconds(late.t_ns - early.t_ns);
  }
  return way / time_s;
}

}  // namespace

ObjectsReport Objects::run(const Map& map, const FrameSet& set, const ScaleReport& scale) {
  paths_.update(map, set.t_ns - to_ns(config.path_s));
  std::vector<MovingPoint> points;
  for (const auto& [id, path] : paths_.all()) {
    const MapPoint& p = *map.find(id);
    const double reach = scale.in_metres.contains(p.map) ? config.reach_m : config.reach_share * mean_distance(map, p);
    points.push_back({id, p.map, path.samples, std::sqrt(p.covariance.trace()), reach});
  }
  return step(points, set.t_ns);
}

ObjectsReport Objects::step(const std::vector<MovingPoint>& points, TimeNs now_ns) {
  const std::vector<Candidate> all = candidates(points, now_ns);
  std::vector<Part> found = parts(all, now_ns);
  name_by_members(found);
  name_by_place(found, now_ns);
  ObjectsReport report{.points = static_cast<int>(all.size())};
  objects_.clear();
  for (Part& part : found) {
    if (part.object == ObjectId()) {
      const bool moves = part.motion.velocity.norm() > config.min_speed * part.reach;
      if (!moves || static_cast<int>(part.points.size()) < config.min_points) continue;
      part.object = ObjectId(next_object_++);
      ++report.started;
    }
    MovingObject& object = objects_.emplace_back();
    object.id = part.object;
    object.map = part.map();
    object.motion = part.motion;
    for (const Candidate* c : part.points) {
      object.members.push_back(c->point->id);
      members_[c->point->id] = {part.object, now_ns};
    }
    Known& known = known_.try_emplace(part.object, Known{.first_ns = now_ns}).first->second;
    known.map = part.map();
    known.motion = part.motion;
    known.reach = part.reach;
    known.last_ns = now_ns;
  }
  std::sort(objects_.begin(), objects_.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  forget(now_ns);
  report.objects = static_cast<int>(objects_.size());
  report.list = objects_;
  return report;
}

std::vector<Objects::Candidate> Objects::candidates(const std::vector<MovingPoint>& points, TimeNs now_ns) const {
  std::vector<Candidate> out;
  for (const MovingPoint& p : points) {
    if (p.reach <= 0 || p.sigma > config.max_sigma * p.reach) continue;
    const auto now = motion_at(p.path, now_ns, now_ns - to_ns(config.path_s), now_ns, config.min_path_s);
    if (now) out.push_back({&p, *now, drift_of(p.path), object_of(p.id)});
  }
  return out;
}

ObjectId Objects::object_of(PointId point) const {
  const auto at = members_.find(point);
  return at == members_.end() ? ObjectId() : at->second.object;
}

bool Objects::lasts(ObjectId object, TimeNs now_ns) const {
  const auto at = known_.find(object);
  return at != known_.end() && to_seconds(now_ns - at->second.first_ns) > config.path_s;
}

std::vector<Objects::Part> Objects::parts(const std::vector<Candidate>& all, TimeNs now_ns) const {
  return Joining(*this, all, now_ns).parts();
}

void Objects::name_by_members(std::vector<Part>& parts) const {
  std::vector<std::tuple<int, ObjectId, Part*>> shared;  // minus members in common: the most come first
  for (Part& part : parts) {
    std::map<ObjectId, int> votes;
    for (const Candidate* c : part.points) {
      if (c->object != ObjectId()) --votes[c->object];
    }
    for (const auto& [object, count] : votes) shared.emplace_back(count, object, &part);
  }
  std::stable_sort(shared.begin(), shared.end(), [](const auto& a, const auto& b) {
    return std::tie(std::get<0>(a), std::get<1>(a)) < std::tie(std::get<0>(b), std::get<1>(b));
  });
  std::map<ObjectId, Part*> taken;
  for (const auto& [count, object, part] : shared) {
    if (part->object != ObjectId() || taken.contains(object)) continue;
    part->object = object;
    taken[object] = part;
  }
}

void Objects::name_by_place(std::vector<Part>& parts, TimeNs now_ns) const {
  for (const auto& [object, known] : known_) {
    const ObjectId id = object;
    if (std::any_of(parts.begin(), parts.end(), [&](const Part& p) { return p.object == id; })) continue;
    const Eigen::Vector3d predicted =
        known.motion.centroid + to_seconds(now_ns - known.last_ns) * known.motion.velocity;
    Part* nearest = nullptr;
    double least = known.reach;
    for (Part& part : parts) {
      const double distance = (part.motion.centroid - predicted).norm();
      if (part.object != ObjectId() || part.map() != known.map || distance > least) continue;
      if ((part.motion.velocity - known.motion.velocity).norm() > config.speed_gate * known.reach) continue;
      nearest = &part;
      least = distance;
    }
    if (nearest != nullptr) nearest->object = id;
  }
}

void Objects::forget(TimeNs now_ns) {
  const TimeNs since_ns = now_ns - to_ns(config.path_s);
  std::erase_if(members_, [&](const auto& entry) { return entry.second.last_ns < since_ns; });
  std::erase_if(known_, [&](const auto& entry) { return entry.second.last_ns < since_ns; });
}

}  // namespace coslam
