// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/doubts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>
#include <vector>

#include "deploy/coslam/eval/statistics.h"
#include "deploy/coslam/eval/truth.h"

namespace coslam::eval {
namespace {

std::string seconds(TimeNs t_ns) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", to_seconds(t_ns));
  return text.data();
}

// By how much later than it says the truth fits best, and how well.
struct TimeFit {
  TimeNs later_ns = 0;
  double rmse_m = 0;
  PosePairs pairs;  // with the times that the truth says
};

TimeFit fit_later(const Trajectory& estimate, const Trajectory& truth, TimeNs gap_ns, TimeNs later_ns) {
  Trajectory moved = estimate;
  for (StampedPose& pose : moved) pose.t_ns -= later_ns;
  PosePairs pairs = pair_poses(moved, truth, gap_ns);
  const Alignment alignment = align_centers({pairs});
  const bool enough = alignment.target_from_source && 2 * pairs.size() > estimate.size();
  return {later_ns, enough ? alignment.rmse : std::numeric_limits<double>::infinity(), std::move(pairs)};
}

// Of those a step apart around a time, up to `steps` to both sides.
TimeFit best_fit(const Trajectory& estimate, const Trajectory& truth, TimeNs gap_ns, TimeNs around_ns, TimeNs step_ns,
                 int steps) {
  TimeFit best = fit_later(estimate, truth, gap_ns, around_ns);
  for (int i = -steps; i <= steps; ++i) {
    TimeFit fit = fit_later(estimate, truth, gap_ns, around_ns + i * step_ns);
    if (fit.rmse_m < best.rmse_m) best = std::move(fit);
  }
  return best;
}

Trajectory inverse_of(Trajectory poses) {
  for (StampedPose& pose : poses) pose.cam_from_world = pose.cam_from_world.inverse();
  return poses;
}

}  // namespace

std::string why_not_judged(const std::string& agent, const Trajectory& poses, const Trajectory& truth,
                           TimeNs max_gap_ns) {
  constexpr std::ptrdiff_t kLeast = 3;  // which a map can be aligned by
  constexpr double kStandsStill_m = 1e-6;
  if (poses.empty() || truth.empty()) return {};
  const auto common = std::ranges::count_if(
      poses, [&](const StampedPose& p) { return p.t_ns >= truth.front().t_ns && p.t_ns <= truth.back().t_ns; });
  if (std::ssize(poses) < kLeast) return {};
  if (common >= kLeast && std::ssize(pair_poses(poses, truth, max_gap_ns)) < kLeast) {
    const TimeNs apart_ns = (truth.back().t_ns - truth.front().t_ns) / std::max<TimeNs>(std::ssize(truth) - 1, 1);
    return "the poses of the truth of agent " + agent + " are " + seconds(apart_ns) +
           " s apart: where the camera was between poses is told over " + seconds(max_gap_ns) + " s at most";
  }
  if (path_length(truth) < kStandsStill_m)
    return "the truth of agent " + agent + " stays in one place: no map can be aligned to it";
  if (common >= kLeast) return {};
  const auto span = [](const Trajectory& t) {
    return seconds(t.front().t_ns) + " to " + seconds(t.back().t_ns) + " s";
  };
  return "the poses of agent " + agent + " are of " + span(poses) + " of the time that was played, its truth of " +
         span(truth) + ": hardly an instant is in both";
}

// On the same poses: an end that is left out may be a bad one.
std::string doubt_of_times(const AgentPaths& agent, TimeNs gap_ns) {
  constexpr std::size_t kEnough = 1000;  // poses
  constexpr TimeNs kCoarse_ns = 50'000'000, kFine_ns = 10'000'000, kLeast_ns = 30'000'000;
  constexpr int kCoarse = 20, kFine = 5;  // steps: within a second
  Trajectory sample;
  const std::size_t every = agent.estimate.size() / kEnough + 1;
  for (std::size_t i = 0; i < agent.estimate.size(); i += every) sample.push_back(agent.estimate[i]);
  TimeFit best = best_fit(sample, agent.truth, gap_ns, 0, kCoarse_ns, kCoarse);
  if (std::abs(best.later_ns) >= kCoarse * kCoarse_ns) return {};
  best = best_fit(sample, agent.truth, gap_ns, best.later_ns, kFine_ns, kFine);
  Trajectory same;
  for (const PosePair& p : best.pairs) same.push_back({p.t_ns + best.later_ns, p.estimate});
  const Alignment as_said = align_centers({pair_poses(same, agent.truth, gap_ns)});
  constexpr double kOfSpread = 0.002;
  if (std::abs(best.later_ns) < kLeast_ns || !as_said.target_from_source || best.rmse_m > as_said.rmse / 2 ||
      as_said.rmse < kOfSpread * as_said.target_spread) {
    return {};
  }
  char text[160];
  std::snprintf(
      text, sizeof text, "fits best %.2f s %s, with an ATE of %.4f m instead of %.4f m: is its clock another?",
      std::abs(to_seconds(best.later_ns)), best.later_ns > 0 ? "later" : "earlier", best.rmse_m, as_said.rmse);
  return "the truth of agent " + agent.name + " " + text;
}

std::string doubt_of_turns(const AgentPaths& agent, const SequenceAgent& listed, double rate_hz) {
  constexpr double kWorthAWord_deg = 2, kTimes = 3;
  const auto off_deg = [&](const Trajectory& truth) {
    const auto error = motion_error({pair_poses(agent.estimate, truth, max_gap_ns(rate_hz))}, 1, to_ns(1));
    return error ? error->rotation_median_deg : 0;
  };
  const double as_read_deg = off_deg(agent.truth);
  if (as_read_deg < kWorthAWord_deg) return {};
  const double other_deg = off_deg(load_truth(listed, rate_hz, QuaternionOrder::kOther));
  const double inverse_deg = off_deg(inverse_of(agent.truth));
  const double best_deg = std::min(other_deg, inverse_deg);
  if (best_deg > std::min(as_read_deg / kTimes, kWorthAWord_deg)) return {};
  char text[200];
  std::snprintf(
      text, sizeof text, "do not fit (%.1f deg off in a second), as if its %s (%.1f deg then): %s", as_read_deg,
      inverse_deg < other_deg ? "poses were from the world to the camera" : "quaternions were in the other order",
      best_deg,
      inverse_deg < other_deg ? "they are to be from the camera to the world"
                              : "w is last in TUM's form, first in EuRoC's");
  return "the turns of the truth of agent " + agent.name + " " + text;
}

std::string doubt_of_unit(const AgentPaths& agent) {
  constexpr double kFastest_m_s = 100;
  const Trajectory& truth = agent.truth;
  std::vector<double> speeds_m_s;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const double step_m = (truth[i].cam_from_world.center() - truth[i - 1].cam_from_world.center()).norm();
    speeds_m_s.push_back(step_m / to_seconds(truth[i].t_ns - truth[i - 1].t_ns));
  }
  const double usual_m_s = speeds_m_s.empty() ? 0 : percentile(speeds_m_s, 50);
  if (usual_m_s < kFastest_m_s) return {};
  char text[96];
  std::snprintf(text, sizeof text, " goes at %.0f m/s: is it in millimetres?", usual_m_s);
  return "the truth of agent " + agent.name + text;
}

}  // namespace coslam::eval
