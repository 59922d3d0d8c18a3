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

namespace coslam {

using LensMatrix = Eigen::Matrix<double, LensCorrection::kTerms, LensCorrection::kTerms>;

// Bundle adjustment: poses and points that minimise the robust reprojection error. Plain arrays, so that the solver
// runs on a copy in a thread of its own.
struct BundleProblem {
  struct Pose {
    Rigid3 cam_from_world;
    int camera = 0;  // index into cameras
    bool fixed = false;
  };
  struct Observation {
    int pose = 0;
    int point = 0;
    Eigen::Vector2d undistorted_px;  // where there are lenses: by the calibration alone
    double sigma_px = 1.0;
    double weight = 1.0;  // less for one of several that repeat an error
  };
  // Two poses whose cameras are fixed to each other.
  struct Tie {
    int first = 0, second = 0;  // poses
    Rigid3 second_from_first;
  };
  // What is right about a camera's lens, and how well its calibration is known beside the observations: zero, with
  // these standard deviations and Cauchy's tails, as a calibration may be of another camera altogether.
  struct Lens {
    LensCorrection start;
    LensCorrection::Values prior_sigma = LensCorrection::Values::Ones();
    bool free = true;  // solved for
  };
  // The logarithm of how much longer the focal length of one image is than its camera's lens says: its raw places lie
  // e^zoom times as far from the principal point. A lens that keeps focusing does that, by percents within seconds. A
  // walk at random about none.
  struct Zoom {
    double start = 0;
    double taken_out = 0;    // of what was observed; the walk is of both together
    int before = -1;         // the pose of the same camera before; -1: the first
    double step_sigma = 1;   // of how it differs from that one
    double prior_sigma = 1;  // of itself
  };
  std::vector<CameraModel> cameras;
  std::vector<Lens> lenses;  // one a camera; or none: observations are undistorted by the right lens
  std::vector<Pose> poses;
  std::vector<Eigen::Vector3d> points;
  std::vector<Observation> observations;
  std::vector<Tie> ties;
  std::vector<std::optional<Zoom>> zooms;  // one a pose, where it is free; or none at all. They need lenses
};

struct BundleConfig {
  int max_iterations = 12;
  double function_tolerance = 1e-4;  // relative change of the cost that ends it
  double loss_sigmas = 2.0;          // Cauchy loss beyond so many standard deviations; 0: squares
  double outlier_sigmas = 4.0;       // an observation farther off after the solution is reported as an outlier
  std::function<void(int done)> after_iteration;  // may be empty
};

struct BundleResult {
  bool usable = false;  // false: the input poses and points stand
  std::vector<Rigid3> poses;
  std::vector<Eigen::Vector3d> points;
  std::vector<LensCorrection> lenses;  // one a camera, where there were any
  std::vector<double> zooms;           // one a pose, where there were any
  // Of their values, zero of those that are given; empty: not known.
  std::vector<LensMatrix> lens_covariances;
  // One per observation: how far it is off in the raw image, infinite behind the camera; whether that is no outlier.
  std::vector<double> errors_px;
  std::vector<bool> is_inlier;
  double initial_cost = 0, final_cost = 0;
  int iterations = 0;
  double sigma_px = 0;  // robust standard deviation of the final residuals, pixels
};

// Deterministic, one thread. At least one fixed pose, or the caller restores the gauge (see fix_gauge).
BundleResult solve_bundle(const BundleProblem& problem, const BundleConfig& config);

// Moves a solution that floated freely back: pose `anchor` as before, and the distance between two camera centres as
// before; not the distance where ties tell lengths.
void fix_gauge(const BundleProblem& before, int anchor, int baseline_end, BundleResult* result);
// Moves a solution that floated freely to where all its poses were, as near as a similarity brings them, or a rigid
// change where ties hold the scale: those who are on their way go on with the least change.
void put_back(const BundleProblem& before, BundleResult* result);

}  // namespace coslam
