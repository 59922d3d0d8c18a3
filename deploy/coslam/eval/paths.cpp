// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "common/base/error.h"
#include "deploy/coslam/eval/doubts.h"
#include "deploy/coslam/eval/evaluation.h"
#include "deploy/coslam/eval/truth.h"

namespace coslam::eval {

TimeNs max_gap_ns(double rate_hz) { return to_ns(std::max(0.1, 2.5 / rate_hz)); }

namespace {

// What the report says of an agent: agents.<name>.frames; null without.
nlohmann::json agents_in(const ResultFolder& result) {
  if (!std::filesystem::exists(result.report())) return nullptr;
  const nlohmann::json report = read_json(result.report());
  return report.contains("agents") && report["agents"].is_object() ? report["agents"] : nlohmann::json();
}

nlohmann::json agent_in(const nlohmann::json& agents, const std::string& name) {
  return agents.is_object() && agents.contains(name) ? agents[name] : nlohmann::json();
}

int frames_of(const nlohmann::json& agent) {
  if (!agent.is_object()) return 0;
  const auto frames = agent.find("frames");
  return frames != agent.end() && frames->is_number_integer() ? frames->get<int>() : 0;
}

Trajectory load_if_there(const std::filesystem::path& file) {
  return std::filesystem::exists(file) ? load_tum(file) : Trajectory();
}

std::optional<double> percent_of(std::optional<double> part, std::optional<double> whole) {
  if (!part || !whole || *whole <= 0) return std::nullopt;
  return 100 * *part / *whole;
}

// The part of an agent's figures that needs no joint alignment.
AgentEvaluation evaluate_alone(const AgentPaths& agent, const PosePairs& pairs, TimeNs gap_ns) {
  AgentEvaluation e;
  e.name = agent.name;
  e.frames = agent.frames > 0 ? agent.frames : static_cast<int>(agent.truth.size());
  e.images = agent.images;
  e.poses = static_cast<int>(agent.estimate.size());
  e.judged = static_cast<int>(pairs.size());
  if (!pairs.empty()) e.judged_s = to_seconds(pairs.back().t_ns - pairs.front().t_ns);
  if (e.poses > 0) e.poses_s = to_seconds(agent.estimate.back().t_ns - agent.estimate.front().t_ns);
  if (!agent.doubt.empty()) e.doubts.push_back(agent.doubt);
  if (const std::string doubt = doubt_of_unit(agent); !doubt.empty()) e.doubts.push_back(doubt);
  for (const auto& [map, poses] : agent.apart) e.poses_apart += static_cast<int>(poses.size());
  if (e.frames > 0) e.tracked_percent = 100.0 * e.poses / e.frames;
  if (!agent.truth.empty()) e.path_m = path_length(agent.truth);
  const Alignment own_alignment = align_centers({pairs});
  if (own_alignment.target_from_source) {
    e.ate_own_m = own_alignment.rmse;
    e.own_scale = own_alignment.target_from_source->scale;
    const std::string doubt = doubt_of_times(agent, gap_ns);
    if (!doubt.empty()) e.doubts.push_back(doubt);
  }
  return e;
}

void evaluate_jointly(AgentEvaluation& e, const PosePairs& pairs, const Similarity3& truth_from_map) {
  e.ate_m = position_rmse(pairs, truth_from_map);
  e.ate_percent = percent_of(e.ate_m, e.path_m);
  e.worst = worst_frame(pairs, truth_from_map);
  e.motion = motion_error({pairs}, truth_from_map.scale, to_ns(1));
  e.drift_m = closing_drift(pairs, truth_from_map);
}

void evaluate_live(Evaluation& e, const std::vector<AgentPaths>& agents, TimeNs gap_ns) {
  std::vector<PosePairs> pairs;
  pairs.reserve(agents.size());
  for (const AgentPaths& agent : agents) pairs.push_back(pair_poses(agent.live, agent.truth, gap_ns));
  const Alignment alignment = align_centers(pairs);
  if (!alignment.target_from_source) return;
  e.live_ate_m = alignment.rmse;
  e.live_ate_percent = percent_of(e.live_ate_m, e.path_m);
  e.live_scale = alignment.target_from_source->scale;
  for (std::size_t i = 0; i < agents.size(); ++i) {
    e.agents[i].live_ate_m = position_rmse(pairs[i], *alignment.target_from_source);
    e.agents[i].live_worst = worst_frame(pairs[i], *alignment.target_from_source);
  }
}

double joint_rmse(const PosePairs& pairs, const Alignment& joint) {
  return position_rmse(pairs, *joint.target_from_source).value_or(0);
}

// Far off together, and not because either of them is lost.
bool contradict(const PosePairs& a, const PosePairs& b) {
  constexpr double kFarM = 0.3, kFarShare = 0.05, kTimes = 5;
  const auto path_m = [](const PosePairs& pairs) {
    double length_m = 0;
    for (std::size_t i = 1; i < pairs.size(); ++i) {
      length_m += (pairs[i].truth.center() - pairs[i - 1].truth.center()).norm();
    }
    return length_m;
  };
  const Alignment joint = align_centers({a, b}), a_alone = align_centers({a}), b_alone = align_centers({b});
  if (!joint.target_from_source || !a_alone.target_from_source || !b_alone.target_from_source) return false;
  const double error_m = std::max(joint_rmse(a, joint), joint_rmse(b, joint));
  return error_m > std::max(kFarM, kFarShare * std::max(path_m(a), path_m(b))) &&
         error_m > kTimes * std::max(a_alone.rmse, b_alone.rmse);
}

}  // namespace

namespace {

struct Member {
  const AgentPaths* agent;
  PosePairs pairs;
};

// What these have in one map, under an alignment of its own.
void evaluate_map(Evaluation& e, MapId id, const std::vector<Member>& members) {
  MapEvaluation map;
  map.id = id;
  std::vector<PosePairs> pairs;
  double path_m = 0;
  for (const Member& m : members) {
    map.agents.insert(m.agent->name);
    pairs.push_back(m.pairs);
    path_m += path_length(m.agent->truth);
  }
  const Alignment alignment = align_centers(pairs);
  if (alignment.target_from_source) {
    map.ate_m = alignment.rmse;
    map.ate_percent = percent_of(map.ate_m, path_m);
    map.scale = alignment.target_from_source->scale;
  }
  e.maps.push_back(map);
  for (std::size_t i = 0; i < members.size(); ++i) {
    for (std::size_t j = i + 1; j < members.size(); ++j) {
      if (contradict(pairs[i], pairs[j])) e.wrong_merges.emplace_back(members[i].agent->name, members[j].agent->name);
    }
  }
}

}  // namespace

void evaluate_maps(Evaluation& e, const std::vector<AgentPaths>& agents, const Partition& maps, double rate_hz) {
  std::map<MapId, std::vector<Member>> apart;
  for (const AgentPaths& agent : agents) {
    for (const auto& [map, poses] : agent.apart) {
      apart[map].push_back({&agent, pair_poses(poses, agent.truth, max_gap_ns(rate_hz))});
    }
  }
  for (const AgentNames& names : maps) {
    std::vector<Member> members;
    for (const AgentPaths& agent : agents) {
      if (!names.contains(agent.name)) continue;
      // One that was never in the common map is judged in its own.
      if (agent.estimate.empty() && !agent.apart.empty()) continue;
      members.push_back({&agent, pair_poses(agent.estimate, agent.truth, max_gap_ns(rate_hz))});
    }
    if (!members.empty()) evaluate_map(e, MapId(), members);
  }
  for (const auto& [map, members] : apart) evaluate_map(e, map, members);
}

namespace {

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

std::vector<AgentPaths> load_paths(const ResultFolder& result, const Sequence& sequence) {
  const ResultContents contents = contents_of(result);
  const nlohmann::json reported = agents_in(result);
  std::vector<AgentPaths> agents;
  bool any = false;
  for (const SequenceAgent& agent : sequence.agents) {
    // A run may leave agents out; one that took part and never found its place counts.
    if (contents.reported && !holds(contents.agents, agent.name)) continue;
    any = any || std::filesystem::exists(result.trajectory(agent.name));
    const nlohmann::json agent_report = agent_in(reported, agent.name);
    agents.push_back({agent.name, load_if_there(result.trajectory(agent.name)), load_if_there(result.live(agent.name)),
                      load_truth(agent, sequence.rate_hz), frames_of(agent_report), images_of(agent_report)});
    agents.back().doubt = doubt_of_turns(agents.back(), agent, sequence.rate_hz);
    for (std::size_t i = 1; i < contents.maps.size(); ++i) {
      const ResultMap& map = contents.maps[i];
      if (!holds(map.agents, agent.name)) continue;
      Trajectory apart = load_if_there(map.folder.trajectory(agent.name));
      if (!apart.empty()) agents.back().apart.emplace(map.id, std::move(apart));
    }
  }
  if (!any) {
    throw UserError(result.path().string() + ": there is no trajectory/<agent>.tum of an agent of " +
                    sequence.file.string());
  }
  return agents;
}

Evaluation evaluate_paths(const std::vector<AgentPaths>& agents, double rate_hz) {
  Evaluation e;
  const TimeNs gap_ns = max_gap_ns(rate_hz);
  std::vector<PosePairs> pairs;
  double path_m = 0, frames = 0, poses = 0;
  for (const AgentPaths& agent : agents) {
    pairs.push_back(pair_poses(agent.estimate, agent.truth, gap_ns));
    e.agents.push_back(evaluate_alone(agent, pairs.back(), gap_ns));
    path_m += e.agents.back().path_m.value_or(0);
    frames += e.agents.back().frames;
    poses += e.agents.back().poses;
  }
  if (path_m > 0) e.path_m = path_m;
  if (frames > 0) e.tracked_percent = 100 * poses / frames;

  e.alignment = align_centers(pairs);
  e.problem = e.alignment.problem;
  if (const auto& truth_from_map = e.alignment.target_from_source) {
    e.ate_m = e.alignment.rmse;
    e.truth_spread_m = e.alignment.target_spread;
    e.ate_percent = percent_of(e.ate_m, e.path_m);
    e.motion = motion_error(pairs, truth_from_map->scale, to_ns(1));
    for (std::size_t i = 0; i < agents.size(); ++i) evaluate_jointly(e.agents[i], pairs[i], *truth_from_map);
  }
  if (agents.size() >= 2) {
    const double scale = e.alignment.target_from_source ? e.alignment.target_from_source->scale : 1.0;
    e.relative_pose = relative_pose_error(pairs[0], pairs[1], scale);
  }
  evaluate_live(e, agents, gap_ns);
  return e;
}

}  // namespace coslam::eval
