// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/two_view.h"

#include "common/geometry/levenberg_marquardt.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>

#include "common/geometry/robust.h"

namespace coslam {
namespace {

using Points = std::vector<Eigen::Vector2d>;

std::vector<cv::Point2d> to_cv(const Points& points) {
  std::vector<cv::Point2d> out;
  for (const Eigen::Vector2d& p : points) out.emplace_back(p.x(), p.y());
  return out;
}

// Signed distance of a match from its epipolar lines, to first order (Sampson).
double sampson(const Eigen::Matrix3d& e, const Eigen::Vector2d& pa, const Eigen::Vector2d& pb) {
  const Eigen::Vector3d a = pa.homogeneous(), b = pb.homogeneous();
  const Eigen::Vector3d line_b = e * a, line_a = e.transpose() * b;
  const double norm2 = line_a.head<2>().squaredNorm() + line_b.head<2>().squaredNorm();
  return b.dot(line_b) / std::sqrt(std::max(norm2, 1e-30));
}

Eigen::Matrix3d essential(const Rigid3& m) { return skew(m.translation) * m.rotation.toRotationMatrix(); }

constexpr double kSigmaOfMedian = 1.4826;  // of what is normally distributed

double median_distance(const Rigid3& m, const Points& pa, const Points& pb) {
  const Eigen::Matrix3d e = essential(m);
  std::vector<double> off;
  for (std::size_t i = 0; i < pa.size(); ++i) off.push_back(std::abs(sampson(e, pa[i], pb[i])));
  return upper_median(off);
}

// Moved by three angles of rotation and two of the direction of translation.
Rigid3 stepped(const Rigid3& m, const Eigen::Matrix<double, 5, 1>& step) {
  const Eigen::Vector3d u = m.translation.unitOrthogonal(), v = m.translation.cross(u);
  return {(so3_exp(step.head<3>()) * m.rotation).normalized(),
          (m.translation + step(3) * u + step(4) * v).normalized()};
}

// Cauchy's cost of the Sampson distances from `scale` on.
double cost_of(const Rigid3& m, const Points& pa, const Points& pb, double scale) {
  const Eigen::Matrix3d e = essential(m);
  double cost = 0;
  for (std::size_t i = 0; i < pa.size(); ++i) {
    const double r = sampson(e, pa[i], pb[i]) / scale;
    cost += std::log1p(r * r);
  }
  return cost;
}

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

// Normal equations of that cost for a step from m.
void linearise(const Rigid3& m, const Points& pa, const Points& pb, double scale, Matrix5d* h, Vector5d* g) {
  constexpr double kStep = 1e-6;
  std::array<Eigen::Matrix3d, 5> shifted;
  for (int k = 0; k < 5; ++k) {
    shifted[static_cast<std::size_t>(k)] = essential(stepped(m, kStep * Vector5d::Unit(k)));
  }
  const Eigen::Matrix3d e = essential(m);
  h->setZero();
  g->setZero();
  for (std::size_t i = 0; i < pa.size(); ++i) {
    const double r = sampson(e, pa[i], pb[i]);
    const double weight = 1 / (1 + r * r / (scale * scale));
    Vector5d j;
    for (int k = 0; k < 5; ++k) j(k) = (sampson(shifted[static_cast<std::size_t>(k)], pa[i], pb[i]) - r) / kStep;
    *h += weight * j * j.transpose();
    *g += weight * r * j;
  }
}

// The motion of least cost, by Levenberg and Marquardt: with a short baseline a turn and a way are hard to tell apart.
Rigid3 polished(Rigid3 m, const Points& pa, const Points& pb, double scale) {
  constexpr int kIterations = 20;
  constexpr double kConverged = 1e-8;
  double cost = cost_of(m, pa, pb, scale);
  Matrix5d h;
  Vector5d g;
  linearise(m, pa, pb, scale, &h, &g);
  levenberg_marquardt({.counts_failures = false}, kIterations, [&](double lambda) {
    Matrix5d damped = h;
    damped.diagonal() *= 1 + lambda;
    damped.diagonal().array() += 1e-12;
    const Vector5d step = -damped.ldlt().solve(g);
    if (!step.allFinite()) return LmStep::kFailed;
    const Rigid3 moved = stepped(m, step);
    const double next_cost = cost_of(moved, pa, pb, scale);
    if (!(next_cost <= cost)) return LmStep::kFailed;
    m = moved;
    cost = next_cost;
    if (step.norm() < kConverged) return LmStep::kConverged;
    linearise(m, pa, pb, scale, &h, &g);
    return LmStep::kImproved;
  });
  return m;
}

// Minimal samples of noisy matches, as RANSAC draws them, are far from the best motion when the baseline is short. And
// most matches are far better than the threshold, which a few that are not on its side would bend the motion by: so the
// scale follows what is left of them.
Rigid3 polished_all(Rigid3 m, const Points& pa, const Points& pb, double threshold) {
  constexpr int kRounds = 4;
  constexpr double kSigmas = 2.5, kLeast = 0.05;  // of the threshold
  double scale = 0.5 * threshold;
  for (int round = 0; round < kRounds; ++round) {
    m = polished(m, pa, pb, scale);
    scale = std::clamp(kSigmas * kSigmaOfMedian * median_distance(m, pa, pb), kLeast * threshold, scale);
  }
  return polished(m, pa, pb, scale);
}

TwoViewMotion judged(const Rigid3& start, const Points& pa, const Points& pb, double threshold) {
  const Rigid3 second_from_first = polished_all(start, pa, pb, threshold);
  TwoViewMotion m{second_from_first, std::vector<bool>(pa.size()), 0};
  const Eigen::Matrix3d r = second_from_first.rotation.toRotationMatrix();
  const Eigen::Vector3d& t = second_from_first.translation;
  const Eigen::Matrix3d e = essential(second_from_first);
  for (std::size_t i = 0; i < pa.size(); ++i) {
    if (std::abs(sampson(e, pa[i], pb[i])) > threshold) continue;
    const Eigen::Vector3d a = pa[i].homogeneous(), b = pb[i].homogeneous();
    // depth_b b = depth_a R a + t: both depths have the sign of these.
    const Eigen::Vector3d ra = r * a, across = b.cross(ra);
    if (b.cross(t).dot(across) > 0 || ra.cross(t).dot(across) > 0) continue;
    m.fits[i] = true;
    ++m.support;
  }
  return m;
}

Rigid3 to_motion(const cv::Mat& r, const cv::Mat& t) {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  cv::cv2eigen(r, rotation);
  cv::cv2eigen(t, translation);
  return {Eigen::Quaterniond(rotation).normalized(), translation.normalized()};
}

// Of those that support alike, the one that matches fit best, by Cauchy's cost at the noise of the best.
const TwoViewMotion* best_of(const std::vector<TwoViewMotion>& motions, const Points& pa, const Points& pb,
                             double threshold) {
  constexpr double kAlike = 0.9;
  const int most = std::ranges::max(motions, {}, &TwoViewMotion::support).support;
  double scale = threshold;
  for (const TwoViewMotion& m : motions) {
    if (m.support >= kAlike * most) {
      scale = std::min(scale, kSigmaOfMedian * median_distance(m.second_from_first, pa, pb));
    }
  }
  scale = std::max(scale, 1e-3 * threshold);
  const TwoViewMotion* best = nullptr;
  double least = 0;
  for (const TwoViewMotion& m : motions) {
    if (m.support < kAlike * most) continue;
    const Eigen::Matrix3d e = essential(m.second_from_first);
    double cost = 0;
    for (std::size_t i = 0; i < pa.size(); ++i) {
      const double off = m.fits[i] ? sampson(e, pa[i], pb[i]) / scale : threshold / scale;
      cost += std::log1p(off * off);
    }
    if (best != nullptr && cost >= least) continue;
    best = &m;
    least = cost;
  }
  return best;
}

// Matches that the rotation nearest to a homography explains alone.
int explained_by_turn(const cv::Mat& homography, const Points& pa, const Points& pb, double threshold) {
  Eigen::Matrix3d h;
  cv::cv2eigen(homography, h);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(h, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d r = svd.matrixU() * svd.matrixV().transpose();
  if (r.determinant() < 0) r = -r;
  int count = 0;
  for (std::size_t i = 0; i < pa.size(); ++i) {
    const Eigen::Vector3d turned = r * pa[i].homogeneous();
    count += turned.z() > 0 && (turned.hnormalized() - pb[i]).norm() < threshold;
  }
  return count;
}

}  // namespace

std::optional<TwoViewMotion> two_view_motion(const std::vector<Eigen::Vector2d>& first,
                                             const std::vector<Eigen::Vector2d>& second, double threshold) {
  constexpr std::size_t kFewest = 8;  // fewer fit any motion
  if (first.size() < kFewest) return std::nullopt;
  const std::vector<cv::Point2d> a = to_cv(first), b = to_cv(second);
  const cv::Mat unit = cv::Mat::eye(3, 3, CV_64F);
  std::vector<TwoViewMotion> motions;
  cv::setRNGSeed(1);
  const cv::Mat e = cv::findEssentialMat(a, b, unit, cv::RANSAC, 0.9999, threshold, 5000);
  if (e.rows == 3 && e.cols == 3) {
    cv::Mat r1, r2, t;
    cv::decomposeEssentialMat(e, r1, r2, t);
    const cv::Mat back = -t;
    for (const cv::Mat& r : {r1, r2}) {
      motions.push_back(judged(to_motion(r, t), first, second, threshold));
      motions.push_back(judged(to_motion(r, back), first, second, threshold));
    }
  }
  const cv::Mat h = cv::findHomography(a, b, cv::RANSAC, 1.5 * threshold, cv::noArray(), 2000, 0.9999);
  int turn = 0;
  if (h.rows == 3 && h.cols == 3) {
    turn = explained_by_turn(h, first, second, 1.5 * threshold);
    std::vector<cv::Mat> rotations, translations, normals;
    cv::decomposeHomographyMat(h, unit, rotations, translations, normals);
    for (std::size_t i = 0; i < rotations.size(); ++i) {
      if (cv::norm(translations[i]) < 1e-9) continue;  // a pure turn has no epipolar lines
      motions.push_back(judged(to_motion(rotations[i], translations[i]), first, second, threshold));
    }
  }
  if (motions.empty()) return std::nullopt;
  const TwoViewMotion* best = best_of(motions, first, second, threshold);
  constexpr double kSameDirection = 0.88;  // cosine of 0.5 rad
  constexpr double kTurnShare = 0.7;
  if (turn > kTurnShare * best->support) return std::nullopt;
  const int clearly = std::max(5, best->support / 20);
  for (const TwoViewMotion& m : motions) {
    const bool other = m.second_from_first.translation.dot(best->second_from_first.translation) < kSameDirection;
    if (other && m.support > best->support - clearly) return std::nullopt;
  }
  return *best;
}

}  // namespace coslam
