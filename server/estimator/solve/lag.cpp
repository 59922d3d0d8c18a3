// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/lag.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/robust.h"

namespace coslam {
namespace {

constexpr double kSpan_s = 0.2;        // over which a speed is taken
constexpr double kInstants_s = 0.1;    // between them
constexpr double kTolerance_s = 0.06;  // of an image that stands for an instant: at 10 Hz there is one
constexpr int kLeastInstants = 15;
constexpr double kLeastSine2 = 0.05;  // of the angle to the line between the cameras, squared
constexpr double kLittle_rad_s = 0.005, kMuch_rad_s = 0.03;
// Of people who walk the right lag has 8 to 17, and 1.24 to twice as much as any other that is 0.3 s and more away.
constexpr double kLeastAgreement = 7.5, kRival = 1.2;
constexpr double kElsewhere_s = 0.3;

const MovingSight* nearest(std::span<const MovingSight> sights, TimeNs t_ns) {
  const auto after = std::ranges::lower_bound(sights, t_ns, {}, &MovingSight::stamp_ns);
  const MovingSight* best = nullptr;
  const auto look = [&](const MovingSight& s) {
    if (std::abs(s.stamp_ns - t_ns) > to_ns(kTolerance_s)) return;
    if (best == nullptr || std::abs(s.stamp_ns - t_ns) < std::abs(best->stamp_ns - t_ns)) best = &s;
  };
  if (after != sights.end()) look(*after);
  if (after != sights.begin()) look(*std::prev(after));
  return best;
}

// Angles about the line between two cameras, against a direction that is at right angles to it.
struct Axis {
  Eigen::Vector3d along, zero, right;

  Axis(const Eigen::Vector3d& line, const Eigen::Vector3d& some_ray) : along(line.normalized()) {
    zero = (some_ray - along * along.dot(some_ray)).normalized();
    right = along.cross(zero);
  }
  std::optional<double> angle(const Eigen::Vector3d& ray) const {
    const double x = ray.dot(zero), y = ray.dot(right);
    if (!(x * x + y * y > kLeastSine2)) return std::nullopt;
    return std::atan2(y, x);
  }
};

// Median over the tracks that are in both images.
std::optional<double> speed_rad_s(const MovingSight& from, const MovingSight& to, const Axis& before,
                                  const Axis& after) {
  if (to.stamp_ns <= from.stamp_ns) return std::nullopt;
  std::vector<double> turns;
  auto next = to.rays.begin();
  for (const MovingSight::Ray& ray : from.rays) {
    while (next != to.rays.end() && next->track < ray.track) ++next;
    if (next == to.rays.end()) break;
    if (next->track != ray.track) continue;
    const auto a = before.angle(ray.direction), b = after.angle(next->direction);
    if (a && b) turns.push_back(std::remainder(*b - *a, 2 * M_PI));
  }
  if (turns.size() < kLeastTracks) return std::nullopt;
  return upper_median(turns) / to_seconds(to.stamp_ns - from.stamp_ns);
}

// How much nearer to each other the two speeds of an instant are than speeds of different instants, over all instants.
double better_than_chance(std::span<const std::array<double, 2>> speeds_rad_s) {
  constexpr std::size_t kOthers = 32;
  // Geman and McClure's, for little noise and for much: what moves evenly needs the former to tell instants apart.
  const auto apart = [](double a, double b) {
    const double miss2 = (a - b) * (a - b);
    return 0.5 * miss2 * (1 / (miss2 + kLittle_rad_s * kLittle_rad_s) + 1 / (miss2 + kMuch_rad_s * kMuch_rad_s));
  };
  const std::size_t n = speeds_rad_s.size(), step = n / kOthers + 1;
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto [a, b] = speeds_rad_s[i];
    double chance = 0;
    int other_count = 0;
    for (std::size_t j = i % step; j < n; j += step, ++other_count) chance += apart(a, speeds_rad_s[j][1]);
    sum += chance / other_count - apart(a, b);
  }
  return sum;
}

}  // namespace

LagAgreement lag_agreement(std::span<const MovingSight> first, std::span<const MovingSight> second, double lag_s) {
  std::vector<std::array<double, 2>> speeds_rad_s;
  TimeNs due_ns = first.empty() ? 0 : first.front().stamp_ns;
  for (const MovingSight& a : first) {
    if (a.stamp_ns < due_ns || a.rays.empty()) continue;
    due_ns = a.stamp_ns + to_ns(kInstants_s);
    const MovingSight* a_after = nearest(first, a.stamp_ns + to_ns(kSpan_s));
    const MovingSight* b = nearest(second, a.stamp_ns - to_ns(lag_s));
    const MovingSight* b_after = nearest(second, a.stamp_ns + to_ns(kSpan_s - lag_s));
    if (a_after == nullptr || b == nullptr || b_after == nullptr) continue;
    const Eigen::Vector3d before = b->center - a.center, after = b_after->center - a_after->center;
    if (!(before.squaredNorm() > 0 && after.squaredNorm() > 0)) continue;
    // The same zero for both, so that angles before and after can be compared.
    const Axis axis(before, a.rays.front().direction), axis_after(after, axis.zero);
    const auto in_a = speed_rad_s(a, *a_after, axis, axis_after), in_b = speed_rad_s(*b, *b_after, axis, axis_after);
    if (in_a && in_b) speeds_rad_s.push_back({*in_a, *in_b});
  }
  return {lag_s, better_than_chance(speeds_rad_s), static_cast<int>(speeds_rad_s.size())};
}

std::optional<double> best_lag_s(std::span<const LagAgreement> lags) {
  const auto counts = [](const LagAgreement& l) { return l.instants >= kLeastInstants; };
  LagAgreement best;
  for (const LagAgreement& l : lags) {
    if (counts(l) && l.agreement > best.agreement) best = l;
  }
  double elsewhere = 0;
  int compared = 0;
  for (const LagAgreement& l : lags) {
    if (!counts(l) || std::abs(l.lag_s - best.lag_s) <= kElsewhere_s) continue;
    elsewhere = std::max(elsewhere, l.agreement);
    ++compared;
  }
  const bool clear = best.agreement > kLeastAgreement && best.agreement > kRival * elsewhere;
  return clear && 4 * compared >= std::ssize(lags) ? std::optional(best.lag_s) : std::nullopt;
}

}  // namespace coslam
