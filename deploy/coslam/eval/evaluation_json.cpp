// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/evaluation_json.h"

namespace coslam::eval {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const std::optional<double>& v) { return v ? Json(*v) : Json(); }

Json json_of(const std::optional<MotionError>& m) {
  if (!m) return nullptr;
  return {{"delta_s", 1},
          {"translation_m", m->translation_rmse_m},
          {"translation_median_m", m->translation_median_m},
          {"rotation_deg", m->rotation_rmse_deg},
          {"rotation_median_deg", m->rotation_median_deg},
          {"count", m->count}};
}

Json json_of(const std::optional<RelativePoseError>& r) {
  if (!r) return nullptr;
  return {{"translation_m", r->translation},
          {"translation_scaled_m", r->translation_scaled},
          {"rotation_deg", r->rotation_deg},
          {"baseline_m", r->baseline_m},
          {"count", r->count}};
}

Json json_of(const std::optional<ErrorSpread>& s) {
  if (!s) return nullptr;
  return {{"median", s->median}, {"p90", s->p90}, {"count", s->count}};
}

Json json_of(const std::optional<ClassificationScore>& c) {
  if (!c) return nullptr;
  return {{"precision", json_of(c->precision)},
          {"recall", json_of(c->recall)},
          {"static_on_moving", json_of(c->static_on_moving)},
          {"false_alarm", json_of(c->false_alarm)},
          {"observations", c->observations}};
}

Json json_of(const BodyScore& b) {
  return {{"instants", b.instants},
          {"dynamic_coverage", json_of(b.coverage())},
          {"object_instants", b.object_instants},
          {"object_found", json_of(b.object_found())},
          {"object_velocity_error_m_s", json_of(b.velocity_error_m_s())}};
}

Json json_of(const GroupChange& c) {
  return {{"t_s", to_seconds(c.t_ns)}, {"kind", c.merge ? "merge" : "split"}, {"first", c.first}, {"second", c.second}};
}

Json json_of(const GroupScore& g) {
  Json json{{"splits", g.count(false)},
            {"splits_found", g.found(false)},
            {"merges", g.count(true)},
            {"merges_found", g.found(true)},
            {"worst_delay_s", json_of(g.worst_delay_s())},
            {"false_splits", g.false_count(false)},
            {"false_merges", g.false_count(true)},
            {"shortest_state_s", json_of(g.shortest_state_s)},
            {"changes", Json::array()},
            {"false_changes", Json::array()}};
  for (const FollowedChange& c : g.changes) {
    json["changes"].push_back(json_of(c.change));
    json["changes"].back()["from_s"] = to_seconds(c.change.from_ns);
    json["changes"].back()["delay_s"] = json_of(c.delay_s);
  }
  for (const GroupChange& c : g.false_changes) json["false_changes"].push_back(json_of(c));
  return json;
}

Json json_of(const MapEvaluation& m) {
  return {{"map", m.id == MapId() ? Json() : Json(m.id.value)},
          {"agents", m.agents},
          {"ate_m", json_of(m.ate_m)},
          {"ate_percent", json_of(m.ate_percent)},
          {"scale", json_of(m.scale)}};
}

Json json_of(const std::optional<WorstFrame>& w) {
  if (!w) return nullptr;
  return {{"error_m", w->error_m}, {"median_m", w->median_m}, {"t_s", to_seconds(w->t_ns)}};
}

Json json_of(const AgentEvaluation& a) {
  return {{"frames", a.frames},
          {"images", a.images.captured() > 0 ? json_of(a.images) : Json()},
          {"poses", a.poses},
          {"poses_apart", a.poses_apart},
          {"judged", a.judged},
          {"judged_s", a.judged_s},
          {"poses_s", a.poses_s},
          {"doubts", a.doubts},
          {"tracked_percent", json_of(a.tracked_percent)},
          {"ate_m", json_of(a.ate_m)},
          {"ate_own_m", json_of(a.ate_own_m)},
          {"ate_percent", json_of(a.ate_percent)},
          {"own_scale", json_of(a.own_scale)},
          {"path_m", json_of(a.path_m)},
          {"rpe", json_of(a.motion)},
          {"drift_m", json_of(a.drift_m)},
          {"live_ate_m", json_of(a.live_ate_m)},
          {"worst_frame", json_of(a.worst)},
          {"live_worst_frame", json_of(a.live_worst)}};
}

}  // namespace

Json to_json(const Evaluation& e) {
  Json json;
  json["sequence"] = e.sequence;
  json["ate_m"] = json_of(e.ate_m);
  json["ate_percent"] = json_of(e.ate_percent);
  json["scale"] = e.alignment.target_from_source ? Json(e.alignment.target_from_source->scale) : Json();
  json["problem"] = e.problem.empty() ? Json() : Json(e.problem);
  json["path_m"] = json_of(e.path_m);
  json["truth_spread_m"] = json_of(e.truth_spread_m);
  json["rpe"] = json_of(e.motion);
  json["tracked_percent"] = json_of(e.tracked_percent);
  json["live"] = {
      {"ate_m", json_of(e.live_ate_m)}, {"ate_percent", json_of(e.live_ate_percent)}, {"scale", json_of(e.live_scale)}};
  json["agents"] = Json::object();
  for (const AgentEvaluation& agent : e.agents) json["agents"][agent.name] = json_of(agent);
  json["relative_pose"] = json_of(e.relative_pose);
  json["points"] = nullptr;
  json["nees"] = nullptr;
  if (const auto& p = e.points) {
    json["points"] = {{"count", p->count},
                      {"error_median_m", p->error_median_m},
                      {"error_p90_m", p->error_p90_m},
                      {"without_truth", p->without_truth}};
    if (p->nees_count > 0) {
      json["nees"] = {{"median", p->nees_median}, {"p90", p->nees_p90}, {"count", p->nees_count}};
    }
  }
  json["classification"] = json_of(e.classification);
  json["dynamic_error_m"] = json_of(e.dynamic_error_m);
  json["dynamic_surface_error_m"] = json_of(e.dynamic_surface_error_m);
  json["dynamic_relative_error"] = json_of(e.dynamic_relative_error);
  json["dynamic_length_s"] = json_of(e.dynamic_length_s);
  const BodyScore bodies = sum_of(e.bodies);
  json["dynamic_coverage"] = json_of(bodies.coverage());
  json["object_found"] = json_of(bodies.object_found());
  json["object_velocity_error_m_s"] = json_of(bodies.velocity_error_m_s());
  json["groups"] = e.groups ? json_of(*e.groups) : Json();
  json["maps"] = Json::array();
  for (const MapEvaluation& m : e.maps) json["maps"].push_back(json_of(m));
  json["wrong_merges"] = e.wrong_merges;
  json["bodies"] = Json::object();
  for (const auto& [name, score] : e.bodies) json["bodies"][name] = json_of(score);
  return json;
}

}  // namespace coslam::eval
