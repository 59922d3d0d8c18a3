// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "server/estimator/motion/objects.h"

// Joins moving points to parts of bodies. Used by Objects alone.
namespace coslam {

struct Objects::Candidate {
  const MovingPoint* point;
  PointMotion now;
  Eigen::Vector3d drift = Eigen::Vector3d::Zero();  // mean velocity over the whole path
  ObjectId object;                                  // object that it was part of
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

// Joins points to parts of bodies, nearest first. Its arguments must outlive it and its parts.
class Objects::Joining {
 public:
  Joining(const Objects& finder, const std::vector<Candidate>& all, TimeNs now_ns);

  // Parts of at least two points. May be called once.
  std::vector<Part> parts();

 private:
  using Members = std::vector<std::size_t>;
  struct Link {
    double distance;  // distance over what is allowed
    std::size_t a, b;
  };

  double reach(const Candidate& a, const Candidate& b) const;
  std::optional<double> stretch(const Candidate& a, const Candidate& b) const;
  std::vector<Link> links() const;
  Eigen::Vector3d drift_of(const Members& part, double* span_s) const;
  double shift(const Members& x, const Members& y) const;
  bool keep_their_distance(const Members& x, const Members& y) const;
  void join(const Link& link);

  const Objects& finder_;
  const std::vector<Candidate>& all_;
  TimeNs now_ns_;
  std::vector<std::size_t> part_of_;
  std::vector<Members> members_;
};

}  // namespace coslam
