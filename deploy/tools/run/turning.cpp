// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/run/turning.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace coslam {
namespace {

constexpr double kMost_s = 10, kStep_s = 0.02;
constexpr double kOver_s = 0.2;    // an angle is taken over that long, so that the noise of poses does not count
constexpr double kLeast_s = 4;     // in which both have poses
constexpr double kAlike = 0.9;     // correlation of two cameras that are held together
constexpr double kRivalry = 0.15;  // by which it is better than half a second and more away
constexpr double kElsewhere_s = 0.5;

struct Series {
  TimeNs begin_ns = 0;
  std::vector<std::optional<double>> angle_rad;  // one each kStep_s
};

Series turns(const Trajectory& path) {
  Series out{path.front().t_ns, {}};
  for (TimeNs t = out.begin_ns; t + to_ns(kOver_s) <= path.back().t_ns; t += to_ns(kStep_s)) {
    const auto from = pose_at(path, t, to_ns(kOver_s)), to = pose_at(path, t + to_ns(kOver_s), to_ns(kOver_s));
    out.angle_rad.push_back(from && to ? std::optional(from->rotation.angularDistance(to->rotation)) : std::nullopt);
  }
  return out;
}

// Pearson's, over the instants that both know, the second's taken so many steps earlier.
std::optional<double> correlation(const Series& a, const Series& b, int earlier) {
  double n = 0, sum_a = 0, sum_b = 0, aa = 0, bb = 0, ab = 0;
  for (int i = 0; i < static_cast<int>(a.angle_rad.size()); ++i) {
    const int j = i - earlier;
    if (j < 0 || j >= static_cast<int>(b.angle_rad.size())) continue;
    const auto &x = a.angle_rad[static_cast<std::size_t>(i)], &y = b.angle_rad[static_cast<std::size_t>(j)];
    if (!x || !y) continue;
    n += 1;
    sum_a += *x;
    sum_b += *y;
    aa += *x * *x;
    bb += *y * *y;
    ab += *x * *y;
  }
  if (n * kStep_s < kLeast_s) return std::nullopt;
  const double spread = (aa - sum_a * sum_a / n) * (bb - sum_b * sum_b / n);
  return spread > 0 ? std::optional((ab - sum_a * sum_b / n) / std::sqrt(spread)) : std::nullopt;
}

}  // namespace

std::optional<double> lag_by_turning_s(const Trajectory& first, const Trajectory& second) {
  if (first.size() < 2 || second.size() < 2) return std::nullopt;
  const Series a = turns(first), b = turns(second);
  const auto apart = static_cast<int>(std::lround(to_seconds(b.begin_ns - a.begin_ns) / kStep_s));
  struct Alike {
    int lag;
    double correlation;
  };
  std::vector<Alike> known;
  const int most = static_cast<int>(kMost_s / kStep_s);
  for (int lag = -most; lag <= most; ++lag) {
    if (const auto c = correlation(a, b, lag + apart)) known.push_back({lag, *c});
  }
  if (known.empty()) return std::nullopt;
  const Alike best = *std::ranges::max_element(known, {}, &Alike::correlation);
  if (best.correlation < kAlike) return std::nullopt;
  const bool rival = std::ranges::any_of(known, [&](const Alike& other) {
    return std::abs(other.lag - best.lag) * kStep_s > kElsewhere_s && other.correlation > best.correlation - kRivalry;
  });
  return rival ? std::nullopt : std::optional(best.lag * kStep_s);
}

}  // namespace coslam
