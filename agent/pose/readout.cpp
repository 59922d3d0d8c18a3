// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/pose/readout.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "agent/pose/turn.h"
#include "common/geometry/rigid3.h"
#include "common/geometry/robust.h"

namespace coslam {
namespace {

constexpr double kApart_s = 0.15;  // images that are compared: the turn has changed, and tracks are still there
constexpr std::size_t kFewestOfRow = 30;
constexpr double kShare = 0.2;  // a view takes part in several pairs, which tell in part the same

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;
// Residual across a direction, and its Jacobian by turn, way and readout.
struct Row {
  Eigen::Matrix<double, 2, 7> j;
  Eigen::Vector2d e;
};

struct Fit {
  Vector7d x = Vector7d::Zero();
  Matrix7d information = Matrix7d::Identity();
};

// Least squares with Tukey's loss at the scale of the residuals.
Fit fit(const std::vector<Row>& rows) {
  constexpr int kRounds = 4;
  constexpr double kTukey = 3.6, kLeastSigma_rad = 1e-5;
  Fit f;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> norms;
    norms.reserve(rows.size());
    for (const Row& r : rows) norms.push_back((r.e - r.j * f.x).norm());
    const double sigma = std::max(robust_sigma_2d(norms), kLeastSigma_rad);
    f.information = 1e-9 * Matrix7d::Identity();
    Vector7d right = Vector7d::Zero();
    for (const Row& r : rows) {
      const double w = tukey_weight((r.e - r.j * f.x).norm() / sigma, kTukey) / (sigma * sigma);
      f.information += w * r.j.transpose() * r.j;
      right += w * r.j.transpose() * r.e;
    }
    f.x = f.information.ldlt().solve(right);
  }
  return f;
}

}  // namespace

std::optional<Eigen::Vector3d> ReadoutEstimate::turn_rad_s() const {
  return images_.empty() ? std::nullopt : images_.back().since_rad_s;
}

void ReadoutEstimate::take(TimeNs capture_ns, const std::vector<SeenPlace>& places) {
  SeenImage now{.capture_ns = capture_ns};
  for (const SeenPlace& p : places) {
    now.seen.emplace(p.track, Seen{camera_.normalized_from_pixel(p.undistorted_px).homogeneous().normalized(),
                                   p.raw_row_px / camera_.height_px - 0.5});
  }
  if (!images_.empty()) measure_turns(&now);
  images_.push_back(std::move(now));
  while (images_.size() > 3 && to_seconds(capture_ns - images_.front().capture_ns) > 2 * kApart_s) images_.pop_front();
}

// The turn at an instant is known when the image after it is there.
void ReadoutEstimate::measure_turns(SeenImage* now) {
  SeenImage& before = images_.back();
  const double since_s = to_seconds(now->capture_ns - before.capture_ns);
  seen_s_ += since_s;
  ++intervals_;
  DirectionPairs pairs;
  for (const auto& [id, seen] : before.seen) {
    const auto at = now->seen.find(id);
    if (at != now->seen.end()) pairs.emplace_back(seen.direction, at->second.direction);
  }
  const auto turn_rad = common_turn_rad(std::move(pairs));
  if (turn_rad && since_s > 0) now->since_rad_s = *turn_rad / since_s;
  if (!before.since_rad_s || !now->since_rad_s) return;
  before.turn_rad_s = 0.5 * (*before.since_rad_s + *now->since_rad_s);
  const auto first = std::ranges::find_if(
      images_, [&](const SeenImage& i) { return before.capture_ns - i.capture_ns <= to_ns(kApart_s); });
  if (&*first != &before && first->turn_rad_s) compare(*first, before);
}

void ReadoutEstimate::compare(const SeenImage& first, const SeenImage& second) {
  DirectionPairs pairs;
  std::vector<std::pair<const Seen*, const Seen*>> both;
  for (const auto& [id, now] : second.seen) {
    const auto at = first.seen.find(id);
    if (at == first.seen.end()) continue;
    both.emplace_back(&at->second, &now);
    pairs.emplace_back(at->second.direction, now.direction);
  }
  if (both.size() < kFewestOfRow) return;
  const auto turn_rad = common_turn_rad(std::move(pairs));
  if (!turn_rad) return;
  const Eigen::Matrix3d turn = so3_exp(*turn_rad).toRotationMatrix();
  std::vector<Row> rows;
  rows.reserve(both.size());
  for (const auto& [a, b] : both) {
    const Eigen::Vector3d& m = b->direction;
    const Eigen::Vector3d side = m.unitOrthogonal();
    Eigen::Matrix<double, 2, 3> across;
    across << side.transpose(), m.cross(side).transpose();
    Row r;
    r.j.leftCols<3>() = -across * skew(m);
    r.j.middleCols<3>(3) = -across;
    r.j.col(6) =
        across * (b->late * second.turn_rad_s->cross(m) - turn * (a->late * first.turn_rad_s->cross(a->direction)));
    r.e = across * (m - turn * a->direction);
    rows.push_back(r);
  }
  const Fit f = fit(rows);
  const double variance_s2 = f.information.ldlt().solve(Vector7d::Unit(6))[6];
  if (variance_s2 > 0 && std::isfinite(f.x[6])) take(f.x[6], variance_s2);
}

void ReadoutEstimate::take(double readout_s, double variance_s2) {
  constexpr double kNoneBetter_s = 1e-3;  // whatever its residuals say: things are at different depths, and go on
  constexpr double kSure_s = 7e-3, kSure = 4.0;
  const double information = kShare / (variance_s2 + kNoneBetter_s * kNoneBetter_s);
  information_ += information;
  weighted_s_ += information * readout_s;
  squares_s2_ += information * readout_s * readout_s;
  pairs_ += kShare;
  if (pairs_ < 2) return;
  const double mean_s = weighted_s_ / information_;
  const double scatter = (squares_s2_ - mean_s * weighted_s_) / (pairs_ - 1);
  const double sigma_s = std::sqrt(std::max(1.0, scatter) / information_);
  const bool sure = sigma_s < kSure_s && mean_s > kSure * sigma_s;
  // Once found it stays so, as well as it is known; no image takes longer than until the next, as they usually come.
  if (sure || readout_s_ > 0) readout_s_ = std::clamp(mean_s, 0.0, seen_s_ / intervals_);
}

}  // namespace coslam
