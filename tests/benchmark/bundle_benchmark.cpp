// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Bundle adjustment against Ceres and COLMAP on the same problem, to the same tolerance, one thread: a window of so
// many cameras (eight key frames that are free, and older poses that hold them), and whole runs of a dozen cameras.
#include <benchmark/benchmark.h>

#include <cmath>
#include <ctime>
#include <random>
#include <vector>

#include "server/estimator/solve/bundle_schur.h"
#include "tests/benchmark/colmap_adjuster.h"
#include "tests/support/ceres_bundle.h"
#include "tests/support/sim_world.h"

namespace coslam {
namespace {

double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Cameras side by side that go along a wall together, a key frame every 0.2 m.
BundleProblem flight(int cameras, int key_frames, int fixed_key_frames) {
  constexpr double kStep_m = 0.2, kApart_m = 0.4, kWall_m = 4;
  constexpr int kPointsAMetre = 60;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  BundleProblem p;
  p.cameras.assign(static_cast<std::size_t>(cameras), test::sim_camera());
  std::vector<Rigid3> truth;
  for (int k = 0; k < key_frames; ++k) {
    for (int c = 0; c < cameras; ++c) {
      truth.push_back(test::looking({kStep_m * k, kApart_m * (c - 0.5 * (cameras - 1)), 0}));
      const Vector6d off =
          Vector6d::NullaryExpr([&](Eigen::Index i) { return (i < 3 ? 0.002 : 0.01) * normal(random); });
      const bool fixed = k < fixed_key_frames || (k == 0 && c == 0);
      p.poses.push_back({fixed ? truth.back() : retract(truth.back(), off), c, fixed});
    }
  }
  const double width_m = kStep_m * key_frames + kWall_m, height_m = kApart_m * cameras + kWall_m;
  std::uniform_real_distribution<double> across(-0.5 * kWall_m, width_m - 0.5 * kWall_m),
      up(-0.5 * height_m, 0.5 * height_m);
  const auto points = static_cast<int>(kPointsAMetre * width_m);
  for (int j = 0; j < points; ++j) {
    const Eigen::Vector3d point(across(random), up(random), kWall_m + 0.5 * normal(random));
    const std::size_t before = p.observations.size();
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Eigen::Vector3d x = truth[i] * point;
      const CameraModel& camera = p.cameras.front();
      if (x.z() < 0.5 || !camera.contains_raw(camera.project(x))) continue;
      const Eigen::Vector2d px = camera.project(x) + 0.5 * Eigen::Vector2d(normal(random), normal(random));
      p.observations.push_back({static_cast<int>(i), static_cast<int>(p.points.size()), px, 0.5});
    }
    if (p.observations.size() < before + 2) {
      p.observations.resize(before);
      continue;
    }
    p.points.emplace_back(point + 0.03 * Eigen::Vector3d(normal(random), normal(random), normal(random)));
  }
  return p;
}

// Both in turn, so that whatever else the machine does weighs on both alike: the ratio that counts.
void compare(benchmark::State& state, const BundleProblem& problem) {
  const BundleConfig config{.max_iterations = 40};
  double ours_s = 0, ceres_s = 0;
  BundleResult ours, other;
  while (state.KeepRunning()) {
    const double start = cpu_s();
    ours = solve_by_schur(problem, config);
    const double middle = cpu_s();
    other = test::solve_by_ceres(problem, config);
    ceres_s += cpu_s() - middle;
    ours_s += middle - start;
  }
  const auto n = static_cast<double>(state.iterations());
  state.counters["poses"] = static_cast<double>(problem.poses.size());
  state.counters["observations"] = static_cast<double>(problem.observations.size());
  state.counters["ours_ms"] = 1e3 * ours_s / n;
  state.counters["ceres_ms"] = 1e3 * ceres_s / n;
  state.counters["ratio"] = ours_s / ceres_s;
  state.counters["cost_ratio"] = ours.final_cost / other.final_cost;
}

void BM_WindowOverCeres(benchmark::State& state) { compare(state, flight(static_cast<int>(state.range(0)), 10, 2)); }
BENCHMARK(BM_WindowOverCeres)->Arg(1)->Arg(3)->Arg(6)->Arg(12)->Unit(benchmark::kMillisecond)->MinTime(1.0);

void BM_WholeOverCeres(benchmark::State& state) { compare(state, flight(12, static_cast<int>(state.range(0)), 0)); }
BENCHMARK(BM_WholeOverCeres)->Arg(25)->Arg(50)->Unit(benchmark::kMillisecond)->Iterations(1);

// Root of the mean squared distance of observations from where their points are, px.
double rms_px(const BundleProblem& p) {
  double sum = 0;
  for (const auto& o : p.observations) {
    const auto& pose = p.poses[static_cast<std::size_t>(o.pose)];
    const Eigen::Vector3d x = pose.cam_from_world * p.points[static_cast<std::size_t>(o.point)];
    sum += (p.cameras[static_cast<std::size_t>(pose.camera)].project(x) - o.undistorted_px).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(p.observations.size()));
}

BundleProblem with(BundleProblem problem, const BundleResult& result) {
  for (std::size_t i = 0; i < problem.poses.size(); ++i) problem.poses[i].cam_from_world = result.poses[i];
  problem.points = result.points;
  return problem;
}

// A whole run by squares, as COLMAP has it.
void BM_WholeOverColmap(benchmark::State& state) {
  const BundleProblem problem = flight(12, static_cast<int>(state.range(0)), 0);
  const BundleConfig config{.max_iterations = 40, .loss_sigmas = 0};
  double ours_s = 0, colmap_s = 0;
  while (state.KeepRunning()) {
    const double start = cpu_s();
    const BundleResult ours = solve_by_schur(problem, config);
    ours_s += cpu_s() - start;
    const auto other = benchmarks::adjust_by_colmap(problem, config);
    if (!other) return state.SkipWithError("COLMAP is not installed");
    colmap_s += other->solver_s;
    state.counters["ours_px"] = rms_px(with(problem, ours));
    state.counters["colmap_px"] = rms_px(other->solved);
  }
  const auto n = static_cast<double>(state.iterations());
  state.counters["poses"] = static_cast<double>(problem.poses.size());
  state.counters["observations"] = static_cast<double>(problem.observations.size());
  state.counters["ours_ms"] = 1e3 * ours_s / n;
  state.counters["colmap_ms"] = 1e3 * colmap_s / n;
  state.counters["ratio"] = ours_s / colmap_s;
}
BENCHMARK(BM_WholeOverColmap)->Arg(2)->Arg(10)->Arg(25)->Arg(50)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace coslam
