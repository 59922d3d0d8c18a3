// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/zoom.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "server/estimator/adjust/lens.h"

namespace coslam {
namespace {

void free_zooms(const RefineJob& job, BundleProblem* problem) {
  constexpr double kPerRootSecond = 0.04, kPrior = 0.02, kShortest_s = 1e-3;
  std::vector<int> in_time(job.poses.size());  // those that only hold come last in the job, and are older
  std::iota(in_time.begin(), in_time.end(), 0);
  const auto set_of = [&](int pose) { return job.poses[static_cast<std::size_t>(pose)].set; };
  std::ranges::stable_sort(in_time, {}, set_of);
  std::vector<int> newest(problem->cameras.size(), -1);
  problem->zooms.resize(job.poses.size());
  for (const int pose : in_time) {
    const auto i = static_cast<std::size_t>(pose);
    int& before = newest[job.poses[i].camera.value];
    BundleProblem::Zoom zoom{.taken_out = job.poses[i].zoom_taken_out, .before = before, .prior_sigma = kPrior};
    if (before >= 0) {
      const std::uint32_t sets = set_of(pose).value - set_of(before).value;
      zoom.step_sigma = kPerRootSecond * std::sqrt(std::max(kShortest_s, job.set_s * sets));
    }
    problem->zooms[i] = zoom;
    before = pose;
  }
}

}  // namespace

void solve_zooms(const RefineJob& job, BundleResult* result) {
  // Half the squared standard deviations that each zoom explains. Cameras that do not breathe come to 0.4 at most, one
  // that does by 2 % within 6 s to 1.5.
  constexpr double kFound = 0.8;
  if (!job.zooms || !result->usable || result->lenses.empty()) return;
  BundleProblem problem = job.problem;
  go_on(*result, &problem);
  free_zooms(job, &problem);
  BundleResult zoomed = solve_bundle(problem, job.config);
  const double gain = zoomed.initial_cost - zoomed.final_cost;
  const bool known = std::ranges::any_of(job.poses, [](const auto& p) { return p.zoom_taken_out != 0; });
  const bool found = known || gain > kFound * static_cast<double>(problem.poses.size());
  if (!zoomed.usable || !found) return;
  *result = std::move(zoomed);
}

void apply_zooms(BundleEdit& edit, const RefineJob& job, const BundleResult& result) {
  std::map<CameraId, std::vector<FrameZoom>> of_cameras;
  for (std::size_t i = 0; i < result.zooms.size(); ++i) {
    const auto& [set, camera, taken_out] = job.poses[i];
    of_cameras[camera].push_back({set, result.zooms[i]});
    edit.note_breathing(edit.map().camera(camera), std::abs(taken_out + result.zooms[i]));
  }
  for (auto& [id, zooms] : of_cameras) {
    std::ranges::sort(zooms, {}, &FrameZoom::set);
    edit.leave_zoom_out(edit.map().camera(id), zooms);
  }
}

}  // namespace coslam
