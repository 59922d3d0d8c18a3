// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <string>

#include "common/base/error.h"
#include "common/base/log.h"
#include "deploy/coslam/commands.h"
#include "deploy/coslam/eval/doubts.h"
#include "deploy/coslam/eval/evaluation.h"
#include "deploy/coslam/eval/evaluation_json.h"
#include "deploy/coslam/eval/evaluation_text.h"
#include "deploy/coslam/plot/top_view.h"
#include "deploy/coslam/result_argument.h"
#include "deploy/coslam/run/played.h"
#include "deploy/coslam/sequence_argument.h"
#include "deploy/simulation/scene.h"

namespace coslam {
namespace {

struct EvalArguments {
  std::string result;
  std::string sequence;
  CoverArguments covered;
  bool json = false;
};

plot::Positions centers(const Trajectory& trajectory, const Similarity3& to) {
  plot::Positions positions;
  for (const StampedPose& pose : trajectory) positions.push_back(to * pose.cam_from_world.center());
  return positions;
}

std::string metres(double length_m) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4f m", length_m);
  return text;
}

std::string path_label(const eval::AgentEvaluation& agent) {
  if (agent.ate_m) return agent.name + ": ATE " + metres(*agent.ate_m);
  return agent.name + ": " + std::to_string(agent.poses) + " poses";
}

// In the frame of the truth where there is one, else in that of the map.
plot::TopView top_view_of(const ResultFolder& result, const std::vector<eval::AgentPaths>& agents,
                          const eval::Evaluation& evaluation) {
  const bool aligned = evaluation.alignment.target_from_source.has_value();
  const Similarity3 shown_from_map = evaluation.alignment.target_from_source.value_or(Similarity3());
  plot::TopView view;
  view.title = evaluation.sequence;
  if (evaluation.ate_m) view.title += ": joint ATE " + metres(*evaluation.ate_m);
  view.unit = aligned ? "m" : "map units";
  if (std::filesystem::exists(result.points())) {
    for (const ResultPoint& point : read_points(result.points())) {
      if (point.state == PointState::kStatic) view.points.push_back(shown_from_map * point.position);
    }
  }
  if (std::filesystem::exists(result.dynamic())) {
    for_each_dynamic_row(result.dynamic(),
                         [&](const ResultDynamicRow& row) { view.moving.push_back(shown_from_map * row.position); });
  }
  double poses = 0;
  for (std::size_t i = 0; i < agents.size(); ++i) {
    poses += static_cast<double>(agents[i].estimate.size());
    view.paths.push_back({path_label(evaluation.agents[i]), centers(agents[i].estimate, shown_from_map),
                          aligned ? centers(agents[i].truth, Similarity3()) : plot::Positions()});
    for (const StampedPose& pose : agents[i].estimate) {
      view.up -= shown_from_map.rotation * (pose.cam_from_world.rotation.conjugate() * Eigen::Vector3d::UnitY());
    }
  }
  if (poses > 0) view.up /= poses;
  return view;
}

int evaluate_result(const EvalArguments& arguments) {
  const ResultFolder result = result_argument(arguments.result);
  Sequence sequence = as_played(sequence_argument(arguments.sequence), result);
  if (const std::string other = of_another_sequence(sequence, result); !other.empty()) log_warn(other);
  cover_lenses(sequence, arguments.covered);
  const auto agents = eval::load_paths(result, sequence);
  std::unique_ptr<Scene> scene;
  if (!sequence.scene.empty()) scene = make_scene(sequence.scene, sequence.scene_seed);

  const eval::Evaluation evaluation = eval::evaluate(result, sequence, agents, scene.get());
  const auto json = eval::to_json(evaluation);
  write_json(result.evaluation(), json);
  plot::save_picture(result.top_view(), plot::draw_top_view(top_view_of(result, agents, evaluation)));
  if (arguments.json) {
    std::printf("%s\n", json.dump(2).c_str());
  } else {
    std::printf("%s  written: %s, %s\n", eval::to_text(evaluation).c_str(), result.evaluation().c_str(),
                result.top_view().c_str());
  }
  bool any_reason = false;
  for (const eval::AgentPaths& agent : agents) {
    const std::string why =
        eval::why_not_judged(agent.name, agent.estimate, agent.truth, eval::max_gap_ns(sequence.rate_hz));
    if (!why.empty()) std::fprintf(stderr, "coslam: %s\n", why.c_str());
    any_reason = any_reason || !why.empty();
  }
  return any_reason && !evaluation.alignment.target_from_source ? 1 : 0;
}

}  // namespace

void add_eval_command(CLI::App& app, Command& chosen) {
  auto arguments = std::make_shared<EvalArguments>();
  CLI::App* command = app.add_subcommand("eval", "Measure a result against the sequence's truth");
  command->add_option("RESULT", arguments->result, "folder of a run, or of a server's runs: the latest")->required();
  command->add_option("SEQUENCE", arguments->sequence, "YAML file, folder with sequence.yaml, or sim:NAME")->required();
  add_cover_option(*command, arguments->covered);
  command->add_flag("--json", arguments->json, "print eval.json instead of a screen of text");
  command->callback([arguments, &chosen] { chosen = [arguments] { return evaluate_result(*arguments); }; });
}

}  // namespace coslam
