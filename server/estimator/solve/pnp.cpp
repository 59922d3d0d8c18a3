// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/pnp.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>

#include "common/geometry/pose_refinement.h"
#include "server/estimator/solve/matching.h"

namespace coslam {

PnpResult solve_pnp(const CameraModel& camera, const std::vector<Eigen::Vector3d>& points,
                    const std::vector<Eigen::Vector2d>& undistorted_px, double sigma_px, int min_inliers) {
  PnpResult result;
  if (static_cast<int>(points.size()) < min_inliers) return result;
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> image;
  for (std::size_t i = 0; i < points.size(); ++i) {
    object.emplace_back(points[i].x(), points[i].y(), points[i].z());
    image.emplace_back(undistorted_px[i].x(), undistorted_px[i].y());
  }
  const cv::Matx33d k(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::Mat rvec, tvec, inliers;
  const double threshold_px = 4.0 * sigma_px * width_scale(camera);
  cv::setRNGSeed(1);
  if (!cv::solvePnPRansac(object, image, k, cv::noArray(), rvec, tvec, false, 2000, static_cast<float>(threshold_px),
                          0.9999, inliers, cv::SOLVEPNP_AP3P)) {
    return result;
  }
  cv::Mat r;
  cv::Rodrigues(rvec, r);
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  cv::cv2eigen(r, rotation);
  cv::cv2eigen(tvec, translation);
  std::vector<PointObservation> observations;
  for (std::size_t i = 0; i < points.size(); ++i)
    observations.push_back({points[i], Eigen::Matrix3d::Zero(), undistorted_px[i]});
  const PoseResult refined = refine_pose(camera, observations, {Eigen::Quaterniond(rotation).normalized(), translation},
                                         {.sigma_px = 1.5 * sigma_px * width_scale(camera)});
  if (refined.status != PoseStatus::kOk || refined.inliers < min_inliers) return result;
  result.ok = true;
  result.cam_from_world = refined.cam_from_world;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (refined.is_inlier[i]) result.inliers.push_back(static_cast<int>(i));
  }
  return result;
}

}  // namespace coslam
