// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/moving_path.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstdlib>

namespace coslam {
namespace {

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace

std::optional<PointMotion> motion_at(const MovingPath& path, TimeNs at_ns, TimeNs from_ns, TimeNs to_ns,
                                     double min_span_s) {
  constexpr double kCurveSpan_s = 0.6;  // a shorter path says too little about its bend
  const auto before = [](const PathSample& s, TimeNs t_ns) { return s.t_ns < t_ns; };
  const auto begin = std::lower_bound(path.begin(), path.end(), from_ns, before);
  const auto end = std::lower_bound(begin, path.end(), to_ns + 1, before);
  if (end - begin < 3 || to_seconds((end - 1)->t_ns - begin->t_ns) < min_span_s) return std::nullopt;
  const double span_s = to_seconds((end - 1)->t_ns - begin->t_ns);
  const int terms = span_s < kCurveSpan_s ? 2 : 3;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero(), b = Eigen::Matrix3d::Zero();
  const PathSample* nearest = &*begin;
  for (auto s = begin; s != end; ++s) {
    const double t_s = to_seconds(s->t_ns - at_ns);
    const Eigen::Vector3d powers(1, t_s, t_s * t_s);
    a += powers * powers.transpose();
    b += powers * s->position.transpose();
    if (std::abs(s->t_ns - at_ns) < std::abs(nearest->t_ns - at_ns)) nearest = &*s;
  }
  if (std::abs(to_seconds(nearest->t_ns - at_ns)) > min_span_s) return std::nullopt;
  PointMotion m;
  m.span_s = span_s;
  m.velocity = a.topLeftCorner(terms, terms).ldlt().solve(b.topRows(terms)).row(1).transpose();
  m.position = nearest->position + to_seconds(at_ns - nearest->t_ns) * m.velocity;
  return m;
}

BodyMotion body_of(std::span<const PointMotion> points) {
  constexpr double kStray = 4;  // times the median deviation
  BodyMotion body;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> at, speed, off;
    for (const PointMotion& p : points) {
      at.push_back(p.position[axis]);
      speed.push_back(p.velocity[axis]);
    }
    body.velocity[axis] = median(speed);
    const double middle = median(at);
    for (const PointMotion& p : points) off.push_back(std::abs(p.position[axis] - middle));
    const double most = kStray * median(off);
    double sum = 0;
    std::vector<double> inliers;
    for (const PointMotion& p : points) {
      if (std::abs(p.position[axis] - middle) > most) continue;
      inliers.push_back(p.position[axis]);
      sum += inliers.back();
    }
    body.centroid[axis] = sum / static_cast<double>(inliers.size());
    for (const double x : inliers) {
      body.extent[axis] = std::max(body.extent[axis], 2 * std::abs(x - body.centroid[axis]));
    }
  }
  return body;
}

}  // namespace coslam
