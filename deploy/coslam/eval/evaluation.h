// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/dataset/report_parts.h"
#include "common/dataset/result.h"
#include "common/dataset/sequence.h"
#include "common/dataset/trajectory.h"
#include "deploy/coslam/eval/bodies.h"
#include "deploy/coslam/eval/groups.h"
#include "deploy/coslam/eval/points.h"
#include "deploy/coslam/eval/trajectories.h"
#include "deploy/simulation/scene.h"

namespace coslam::eval {

// Paths of one agent in a result and in the truth; empty where there is none.
struct AgentPaths {
  std::string name;
  Trajectory estimate;
  Trajectory live;
  Trajectory truth;  // truth in the played part
  int frames = 0;    // frames of the source; 0 = not known
  ImageAccount images;
  // Paths in maps without a known relation to the common one.
  std::map<MapId, Trajectory> apart;
  std::string doubt;  // a sentence: the truth may have been read otherwise than it was meant; empty: none
};

// Lengths are metres of the truth. Empty means not known, never zero.
struct AgentEvaluation {
  std::string name;
  int frames = 0;
  ImageAccount images;                    // fates of its images, from the run's report
  int poses = 0;                          // in the common map
  int poses_apart = 0;                    // in others
  int judged = 0;                         // poses in the common map for which there is truth
  double judged_s = 0, poses_s = 0;       // times from the first to the last of `judged` and of `poses`
  std::optional<double> tracked_percent;  // in the common map
  std::optional<double> path_m;
  std::optional<double> ate_m;      // under the joint alignment
  std::optional<double> ate_own_m;  // under an alignment of its own
  std::optional<double> ate_percent;
  std::optional<double> own_scale;
  std::optional<double> live_ate_m;  // under the joint alignment of the live poses
  std::optional<WorstFrame> worst, live_worst;
  std::optional<MotionError> motion;
  std::optional<double> drift_m;
  std::vector<std::string> doubts;  // doubts about the truth, sentences
};

struct ClassificationScore {
  std::optional<double> precision, recall, static_on_moving, false_alarm;
  int observations = 0;
};

// Agents that share a map, under an alignment of their own.
struct MapEvaluation {
  MapId id;  // id of a map apart; 0: agents that share the common one
  AgentNames agents;
  std::optional<double> ate_m, ate_percent, scale;
};

struct Evaluation {
  std::string sequence;
  std::vector<AgentEvaluation> agents;
  Alignment alignment;  // truth from map, one for all agents
  std::string problem;  // why there is no alignment
  std::optional<double> ate_m, ate_percent, path_m, tracked_percent;
  std::optional<double> truth_spread_m;  // RMS distance of the true positions of all agents from their mean
  std::optional<double> live_ate_m, live_ate_percent, live_scale;
  std::optional<MotionError> motion;
  std::optional<RelativePoseError> relative_pose;  // error between the first two agents
  std::optional<PointAccuracy> points;
  std::optional<ClassificationScore> classification;
  std::optional<ErrorSpread> dynamic_error_m;          // against the marked points
  std::optional<ErrorSpread> dynamic_surface_error_m;  // against the surface that the pixels show
  std::optional<ErrorSpread> dynamic_relative_error;   // error over the distance of the nearest camera that sees it
  std::optional<double> dynamic_length_s;              // median of the paths
  std::map<std::string, BodyScore> bodies;             // bodies of a simulated scene, by name
  std::optional<GroupScore> groups;                    // empty unless the true overlap is known
  std::vector<MapEvaluation> maps;
  // Two agents of a map that do not fit together, while each alone follows its true path.
  std::vector<std::pair<std::string, std::string>> wrong_merges;
};

// Reads the paths of the agents that took part. Throws UserError when the result has no trajectory at all.
std::vector<AgentPaths> load_paths(const ResultFolder& result, const Sequence& sequence);

// Longest gap over which truth is interpolated.
TimeNs max_gap_ns(double rate_hz);

// The trajectory part of the evaluation. rate_hz of the sequence bounds the gaps that truth is interpolated over.
Evaluation evaluate_paths(const std::vector<AgentPaths>& agents, double rate_hz);

// The maps that the agents share, each aligned by itself, and whether they should share them.
void evaluate_maps(Evaluation& e, const std::vector<AgentPaths>& agents, const Partition& maps, double rate_hz);

// Everything. scene: the world of a simulated sequence, or null.
Evaluation evaluate(const ResultFolder& result, const Sequence& sequence, const std::vector<AgentPaths>& agents,
                    const Scene* scene);

}  // namespace coslam::eval
