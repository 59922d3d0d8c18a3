// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>

namespace coslam {
namespace {

constexpr double kLasting = 1.5;  // the reach grows so within what was one object, and shrinks between what was two

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

struct Objects::Candidate {
  const MovingPoint* point;
  PointMotion now;
  Eigen::Vector3d drift = Eigen::Vector3d::Zero();  // mean velocity over the whole path
  ObjectId object;                                  // that it was part of
};

struct Objects::Part {
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

// Points joined to parts of bodies, nearest first.
class Objects::Joining {
 public:
  Joining(const Objects& finder, const std::vector<Candidate>& all, TimeNs now_ns)
      : finder_(finder), all_(all), now_ns_(now_ns), part_of_(all.size()), members_(all.size()) {
    std::iota(part_of_.begin(), part_of_.end(), 0U);
    for (std::size_t i = 0; i < all.size(); ++i) members_[i] = {i};
  }

  std::vector<Part> parts() {
    for (const Link& link : links()) join(link);
    std::vector<Part> out;
    for (Members& part : members_) {
      if (part.size() < 2) continue;
      std::sort(part.begin(), part.end());
      Part& p = out.emplace_back();
      for (const std::size_t i : part) p.points.push_back(&all_[i]);
      p.measure();
    }
    return out;
  }

 private:
  using Members = std::vector<std::size_t>;
  struct Link {
    double distance;  // over what is allowed
    std::size_t a, b;
  };

  // How near two points have to be to be neighbours.
  double reach(const Candidate& a, const Candidate& b) const {
    const double least = std::min(a.point->reach, b.point->reach);
    if (a.object == ObjectId() || b.object == ObjectId()) return least;
    if (a.object == b.object) return kLasting * least;
    return finder_.lasts(a.object, now_ns_) && finder_.lasts(b.object, now_ns_) ? least / kLasting : least;
  }
  std::optional<double> stretch(const Candidate& a, const Candidate& b) const {
    return stretch_of(a.point->path, b.point->path, finder_.config.path_s);
  }

  std::vector<Link> links() const {
    std::vector<Link> out;
    for (std::size_t a = 0; a < all_.size(); ++a) {
      for (std::size_t b = a + 1; b < all_.size(); ++b) {
        if (all_[a].point->map != all_[b].point->map) continue;
        const double distance = (all_[a].now.position - all_[b].now.position).norm() / reach(all_[a], all_[b]);
        if (distance < 1) out.push_back({distance, a, b});
      }
    }
    std::sort(out.begin(), out.end(), [](const Link& x, const Link& y) {
      return std::tie(x.distance, x.a, x.b) < std::tie(y.distance, y.a, y.b);
    });
    return out;
  }

  Eigen::Vector3d drift_of(const Members& part, double* span_s) const {
    std::vector<PointMotion> motions;
    for (const std::size_t i : part) {
      motions.push_back({.velocity = all_[i].drift});
      *span_s += to_seconds(all_[i].point->path.back().t_ns - all_[i].point->path.front().t_ns) /
                 static_cast<double>(part.size());
    }
    return body_of(motions).velocity;
  }
  // How far two parts shifted against each other on their newest path.
  double shift(const Members& x, const Members& y) const {
    double span_x_s = 0, span_y_s = 0;
    const Eigen::Vector3d apart = drift_of(x, &span_x_s) - drift_of(y, &span_y_s);
    return apart.norm() * std::min(span_x_s, span_y_s);
  }

  // Most of the points of two parts that are near each other keep their distance. One pair of many does so by chance.
  bool keep_their_distance(const Members& x, const Members& y) const {
    constexpr std::size_t kMostPairs = 60;
    const std::size_t every = 1 + x.size() * y.size() / kMostPairs;
    int near = 0, steady = 0;
    for (std::size_t k = 0; k < x.size() * y.size(); k += every) {
      const Candidate &a = all_[x[k / y.size()]], &b = all_[y[k % y.size()]];
      if ((a.now.position - b.now.position).norm() > reach(a, b)) continue;
      const auto change = stretch(a, b);
      if (!change) continue;
      ++near;
      steady += *change <= finder_.config.stretch * reach(a, b);
    }
    return 2 * steady >= near;
  }

  void join(const Link& link) {
    const std::size_t into = part_of_[link.a], from = part_of_[link.b];
    if (into == from) return;
    const double near = reach(all_[link.a], all_[link.b]);
    const auto change = stretch(all_[link.a], all_[link.b]);
    if (!change || *change > finder_.config.stretch * near) return;
    const std::size_t least = std::min(members_[into].size(), members_[from].size());
    const bool bodies = static_cast<int>(least) >= finder_.config.min_points;
    if (bodies && (shift(members_[into], members_[from]) > finder_.config.shift * near ||
                   !keep_their_distance(members_[into], members_[from])))
      return;
    for (const std::size_t i : members_[from]) part_of_[i] = into;
    members_[into].insert(members_[into].end(), members_[from].begin(), members_[from].end());
    members_[from].clear();
  }

  const Objects& finder_;
  const std::vector<Candidate>& all_;
  TimeNs now_ns_;
  std::vector<std::size_t> part_of_;
  std::vector<Members> members_;
};

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
