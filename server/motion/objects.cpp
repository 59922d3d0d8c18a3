// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/motion/objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>

namespace coslam {
namespace {

constexpr double kTogether = 1.5;  // reach within what was one object
constexpr double kApart = 0.6;     // and between what was two for a while

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

// By how much the distance of two points changed on their common path, from means over parts of it so that noise does
// not count; empty when there is too little in common.
std::optional<double> stretch_of(const MovingPath& a, const MovingPath& b, double path_s) {
  constexpr std::size_t kParts = 5, kLeastParts = 2, kLeast = 3;
  std::vector<std::pair<TimeNs, double>> distances;
  auto p = a.begin();
  auto q = b.begin();
  while (p != a.end() && q != b.end()) {
    if (p->set < q->set) {
      ++p;
    } else if (q->set < p->set) {
      ++q;
    } else {
      distances.emplace_back(p->t_ns, (p->position - q->position).norm());
      ++p;
      ++q;
    }
  }
  if (distances.size() < kLeastParts * kLeast) return std::nullopt;
  // A short path has two parts that are short.
  const double span_s = to_seconds(distances.back().first - distances.front().first);
  const std::size_t parts = std::clamp(static_cast<std::size_t>(kParts * span_s / path_s), kLeastParts,
                                       std::min(kParts, distances.size() / kLeast));
  double least = std::numeric_limits<double>::max(), most = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = part * distances.size() / parts, end = (part + 1) * distances.size() / parts;
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += distances[i].second;
    const double mean = sum / static_cast<double>(end - begin);
    least = std::min(least, mean);
    most = std::max(most, mean);
  }
  return most - least;
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

struct ObjectFinder::Candidate {
  const MovingPoint* point;
  PointMotion now;
  Eigen::Vector3d drift = Eigen::Vector3d::Zero();  // mean velocity over the whole path
  ObjectId object;                                  // that it was part of
};

struct ObjectFinder::Part {
  std::vector<const Candidate*> points;
  ObjectId object;  // 0 = none yet
  BodyMotion motion;
  double reach = 0;

  MapId map() const { return points.front()->point->map; }
  void measure() {
    std::vector<PointMotion> motions;
    reach = 0;
    for (const Candidate* c : points) {
      motions.push_back(c->now);
      reach += c->point->reach / static_cast<double>(points.size());
    }
    motion = body_of(motions);
  }
};

ObjectsReport ObjectFinder::run(const Map& map, const FrameSet& set, const ScaleReport& scale) {
  paths_.update(map, set.t_ns - to_ns(config.path_s));
  std::vector<MovingPoint> points;
  for (const auto& [id, path] : paths_.all()) {
    const MapPoint& p = *map.find(id);
    const double reach = scale.in_metres.contains(p.map) ? config.reach_m : config.reach_share * mean_distance(map, p);
    points.push_back({id, p.map, path.samples, std::sqrt(p.covariance.trace()), reach});
  }
  return step(points, set.t_ns);
}

ObjectsReport ObjectFinder::step(const std::vector<MovingPoint>& points, TimeNs now_ns) {
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

std::vector<ObjectFinder::Candidate> ObjectFinder::candidates(const std::vector<MovingPoint>& points,
                                                              TimeNs now_ns) const {
  std::vector<Candidate> out;
  for (const MovingPoint& p : points) {
    if (p.reach <= 0 || p.sigma > config.max_sigma * p.reach) continue;
    const auto now = motion_at(p.path, now_ns, now_ns - to_ns(config.path_s), now_ns, config.min_path_s);
    if (now) out.push_back({&p, *now, drift_of(p.path), object_of(p.id)});
  }
  return out;
}

ObjectId ObjectFinder::object_of(PointId point) const {
  const auto at = members_.find(point);
  return at == members_.end() ? ObjectId() : at->second.object;
}

bool ObjectFinder::lasts(ObjectId object, TimeNs now_ns) const {
  const auto at = known_.find(object);
  return at != known_.end() && to_seconds(now_ns - at->second.first_ns) > config.path_s;
}

std::vector<ObjectFinder::Part> ObjectFinder::parts(const std::vector<Candidate>& all, TimeNs now_ns) const {
  struct Link {
    double distance;  // over what is allowed
    std::size_t a, b;
  };
  const auto hold = [&](const Candidate& a, const Candidate& b) {
    if (a.object == ObjectId() || b.object == ObjectId()) return 1.0;
    if (a.object == b.object) return kTogether;
    return lasts(a.object, now_ns) && lasts(b.object, now_ns) ? kApart : 1.0;
  };
  std::vector<Link> links;
  for (std::size_t a = 0; a < all.size(); ++a) {
    for (std::size_t b = a + 1; b < all.size(); ++b) {
      if (all[a].point->map != all[b].point->map) continue;
      const double reach = hold(all[a], all[b]) * std::min(all[a].point->reach, all[b].point->reach);
      const double distance = (all[a].now.position - all[b].now.position).norm() / reach;
      if (distance < 1) links.push_back({distance, a, b});
    }
  }
  std::sort(links.begin(), links.end(), [](const Link& x, const Link& y) {
    return std::tie(x.distance, x.a, x.b) < std::tie(y.distance, y.a, y.b);
  });
  std::vector<std::size_t> part_of(all.size());
  std::iota(part_of.begin(), part_of.end(), 0U);
  std::vector<std::vector<std::size_t>> members(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) members[i] = {i};
  // How far two parts shifted against each other on their newest path.
  const auto shift = [&](const std::vector<std::size_t>& x, const std::vector<std::size_t>& y) {
    const auto motion = [&](const std::vector<std::size_t>& part, double* span_s) {
      std::vector<PointMotion> motions;
      for (const std::size_t i : part) {
        motions.push_back({.velocity = all[i].drift});
        *span_s += to_seconds(all[i].point->path.back().t_ns - all[i].point->path.front().t_ns) /
                   static_cast<double>(part.size());
      }
      return body_of(motions).velocity;
    };
    double span_x_s = 0, span_y_s = 0;
    const Eigen::Vector3d apart = motion(x, &span_x_s) - motion(y, &span_y_s);
    return apart.norm() * std::min(span_x_s, span_y_s);
  };
  // Most of the points of two parts that are near each other keep their distance. One pair of many does so by chance.
  const auto together = [&](const std::vector<std::size_t>& x, const std::vector<std::size_t>& y) {
    constexpr std::size_t kMostPairs = 60;
    const std::size_t every = 1 + x.size() * y.size() / kMostPairs;
    int near = 0, kept = 0;
    for (std::size_t k = 0; k < x.size() * y.size(); k += every) {
      const Candidate &a = all[x[k / y.size()]], &b = all[y[k % y.size()]];
      const double reach = hold(a, b) * std::min(a.point->reach, b.point->reach);
      if ((a.now.position - b.now.position).norm() > reach) continue;
      const auto stretch = stretch_of(a.point->path, b.point->path, config.path_s);
      if (!stretch) continue;
      ++near;
      kept += *stretch <= config.stretch * reach;
    }
    return 2 * kept >= near;
  };
  for (const Link& link : links) {
    const std::size_t into = part_of[link.a], from = part_of[link.b];
    if (into == from) continue;
    const Candidate &a = all[link.a], &b = all[link.b];
    const double reach = hold(a, b) * std::min(a.point->reach, b.point->reach);
    const auto stretch = stretch_of(a.point->path, b.point->path, config.path_s);
    if (!stretch || *stretch > config.stretch * reach) continue;
    constexpr std::size_t kBody = 3;
    if (members[into].size() >= kBody && members[from].size() >= kBody &&
        (shift(members[into], members[from]) > config.shift * reach || !together(members[into], members[from]))) {
      continue;
    }
    for (const std::size_t i : members[from]) part_of[i] = into;
    members[into].insert(members[into].end(), members[from].begin(), members[from].end());
    members[from].clear();
  }
  std::vector<Part> out;
  for (std::vector<std::size_t>& part : members) {
    if (part.size() < 2) continue;
    std::sort(part.begin(), part.end());
    Part& p = out.emplace_back();
    for (const std::size_t i : part) p.points.push_back(&all[i]);
    p.measure();
  }
  return out;
}

void ObjectFinder::name_by_members(std::vector<Part>& parts) const {
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

void ObjectFinder::name_by_place(std::vector<Part>& parts, TimeNs now_ns) const {
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

void ObjectFinder::forget(TimeNs now_ns) {
  const TimeNs since_ns = now_ns - to_ns(config.keep_s);
  std::erase_if(members_, [&](const auto& entry) { return entry.second.last_ns < since_ns; });
  std::erase_if(known_, [&](const auto& entry) { return entry.second.last_ns < since_ns; });
}

}  // namespace coslam
