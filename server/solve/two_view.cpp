// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/solve/two_view.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>

namespace coslam {
namespace {

using Points = std::vector<Eigen::Vector2d>;

std::vector<cv::Point2d> to_cv(const Points& points) {
  std::vector<cv::Point2d> out;
  for (const Eigen::Vector2d& p : points) out.emplace_back(p.x(), p.y());
  return out;
}

TwoViewMotion judged(const Rigid3& second_from_first, const Points& pa, const Points& pb, double threshold) {
  TwoViewMotion m{second_from_first, std::vector<bool>(pa.size()), 0};
  const Eigen::Matrix3d r = second_from_first.rotation.toRotationMatrix();
  const Eigen::Vector3d& t = second_from_first.translation;
  const Eigen::Matrix3d e = skew(t) * r;
  for (std::size_t i = 0; i < pa.size(); ++i) {
    const Eigen::Vector3d a(pa[i].x(), pa[i].y(), 1), b(pb[i].x(), pb[i].y(), 1);
    const Eigen::Vector3d line_b = e * a, line_a = e.transpose() * b;
    const double error = b.dot(line_b), norm2 = line_a.head<2>().squaredNorm() + line_b.head<2>().squaredNorm();
    if (error * error > threshold * threshold * norm2) continue;  // Sampson's distance
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
  const auto best =
      std::max_element(motions.begin(), motions.end(),
                       [](const TwoViewMotion& x, const TwoViewMotion& y) { return x.support < y.support; });
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
