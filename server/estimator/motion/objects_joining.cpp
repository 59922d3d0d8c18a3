// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/objects_joining.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace coslam {
namespace {

constexpr double kLasting = 1.5;  // the reach grows so within what was one object, and shrinks between what was two

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

}  // namespace

Objects::Joining::Joining(const Objects& finder, const std::vector<Candidate>& all, TimeNs now_ns)
    : finder_(finder), all_(all), now_ns_(now_ns), part_of_(all.size()), members_(all.size()) {
  std::iota(part_of_.begin(), part_of_.end(), 0U);
  for (std::size_t i = 0; i < all.size(); ++i) members_[i] = {i};
}

std::vector<Objects::Part> Objects::Joining::parts() {
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

// How near two points have to be to be neighbours.
double Objects::Joining::reach(const Candidate& a, const Candidate& b) const {
  const double least = std::min(a.point->reach, b.point->reach);
  if (a.object == ObjectId() || b.object == ObjectId()) return least;
  if (a.object == b.object) return kLasting * least;
  return finder_.lasts(a.object, now_ns_) && finder_.lasts(b.object, now_ns_) ? least / kLasting : least;
}

std::optional<double> Objects::Joining::stretch(const Candidate& a, const Candidate& b) const {
  return stretch_of(a.point->path, b.point->path, finder_.config.path_s);
}

std::vector<Objects::Joining::Link> Objects::Joining::links() const {
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

Eigen::Vector3d Objects::Joining::drift_of(const Members& part, double* span_s) const {
  std::vector<PointMotion> motions;
  for (const std::size_t i : part) {
    motions.push_back({.velocity = all_[i].drift});
    *span_s += to_seconds(all_[i].point->path.back().t_ns - all_[i].point->path.front().t_ns) /
               static_cast<double>(part.size());
  }
  return body_of(motions).velocity;
}

// How far two parts shifted against each other on their newest path.
double Objects::Joining::shift(const Members& x, const Members& y) const {
  double span_x_s = 0, span_y_s = 0;
  const Eigen::Vector3d apart = drift_of(x, &span_x_s) - drift_of(y, &span_y_s);
  return apart.norm() * std::min(span_x_s, span_y_s);
}

// Most of the points of two parts that are near each other keep their distance. One pair of many does so by chance.
bool Objects::Joining::keep_their_distance(const Members& x, const Members& y) const {
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

void Objects::Joining::join(const Link& link) {
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

}  // namespace coslam
