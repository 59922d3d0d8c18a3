// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "common/geometry/camera_model.h"
#include "common/geometry/lens_correction.h"
#include "common/geometry/rigid3.h"
#include "common/geometry/robust.h"

namespace coslam {

// Freedoms of a map that no image tells: translation, rotation, scale.
inline constexpr int kGaugeFreedoms = 7;

using LensMatrix = Eigen::Matrix<double, LensCorrection::kTerms, LensCorrection::kTerms>;

// Bundle adjustment problem: poses and points that minimise the robust reprojection error. Plain arrays, so that the
// solver runs on a copy in its own thread.
struct BundleProblem {
  struct Pose {
    Rigid3 cam_from_world;
    int camera = 0;  // index into cameras
    bool fixed = false;
  };
  struct Observation {
    int pose = 0;
    int point = 0;
    Eigen::Vector2d undistorted_px;  // undistorted by the calibration alone where there are lenses
    double sigma_px = 1.0;
    double weight = 1.0;  // less for one of several that repeat an error
  };
  // Two poses whose cameras are fixed to each other.
  struct Tie {
    int first = 0, second = 0;  // poses
    Rigid3 second_from_first;
  };
  // Correction of a camera's lens, where to start, and its prior from the calibration: zero, with these standard
  // deviations and Cauchy's tails, because a calibration may belong to another camera altogether.
  struct Lens {
    LensCorrection start;
    LensCorrection::Values prior_sigma = LensCorrection::Values::Ones();
    bool free = true;  // solved for
  };
  // Zoom of one image (focus breathing): logarithm of how much longer its focal length is than its camera's lens says.
  // Raw pixels lie e^zoom times as far from the principal point. A lens that keeps focusing changes by percents within
  // seconds. Modelled as a random walk around zero.
  struct Zoom {
    double start = 0;
    double taken_out = 0;    // zoom that the observations were corrected for already; the walk is of the sum
    int before = -1;         // previous pose of the same camera; -1: none
    double step_sigma = 1;   // standard deviation of the difference to the previous zoom
    double prior_sigma = 1;  // standard deviation of the zoom
  };
  std::vector<CameraModel> cameras;
  std::vector<Lens> lenses;  // one per camera; or none: observations are undistorted by the right lens
  std::vector<Pose> poses;
  std::vector<Eigen::Vector3d> points;
  std::vector<Observation> observations;
  std::vector<Tie> ties;
  std::vector<std::optional<Zoom>> zooms;  // one per pose, empty where zoom is 0; or none at all. Needs lenses
};

// Least number of points with which a pose takes part in an adjustment: fewer do not hold it.
inline constexpr int kLeastPointsOfPose = 8;

struct BundleConfig {
  int max_iterations = 12;
  double function_tolerance = 1e-4;    // relative change of the cost that ends the iterations
  double loss_sigmas = kCauchySigmas;  // Cauchy loss beyond so many standard deviations; 0: squares
  double outlier_sigmas = 4.0;         // an observation farther off after the solution is reported as an outlier
  std::function<void(int done)> after_iteration;  // may be empty
};

struct BundleResult {
  bool usable = false;  // false: the input poses and points stand
  std::vector<Rigid3> poses;
  std::vector<Eigen::Vector3d> points;
  std::vector<LensCorrection> lenses;  // one per camera, if the problem has lenses
  std::vector<double> zooms;           // one per pose, if the problem has zooms
  // Covariances of the lenses' values, zero for lenses that are not free; empty: not known.
  std::vector<LensMatrix> lens_covariances;
  // Error of each observation in the raw image, infinite behind the camera, and whether it is an inlier.
  std::vector<double> errors_px;
  std::vector<bool> is_inlier;
  double initial_cost = 0, final_cost = 0;
  int iterations = 0;
  double sigma_px = 0;  // robust standard deviation of the final residuals, pixels
};

// Solves a bundle adjustment problem; deterministic, one thread. At least one pose is fixed, or the caller restores the
// gauge (see fix_gauge).
BundleResult solve_bundle(const BundleProblem& problem, const BundleConfig& config);

// Restores the gauge of a solution without fixed poses: pose `anchor` and the distance between two camera centres
// become as before; the distance only where no ties determine the scale.
void fix_gauge(const BundleProblem& before, int anchor, int baseline_end, BundleResult* result);
// Restores the gauge of a solution without fixed poses: all poses become as they were, as near as a similarity brings
// them, or a rigid motion where ties determine the scale. Cameras that keep moving are disturbed least this way.
void put_back(const BundleProblem& before, BundleResult* result);

}  // namespace coslam
