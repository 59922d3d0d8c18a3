// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/evaluation_text.h"

#include <algorithm>

#include "common/base/printed.h"

namespace coslam::eval {
namespace {

// A number in a column, or a dash.
std::string cell(const std::optional<double>& v, int width, int decimals) {
  return v ? printed("%*.*f", width, decimals, *v) : printed("%*s", width, "-");
}

std::string agent_row(const AgentEvaluation& a) {
  const auto translation = a.motion ? std::optional(a.motion->translation_rmse_m) : std::nullopt;
  const auto rotation = a.motion ? std::optional(a.motion->rotation_rmse_deg) : std::nullopt;
  return printed("  %-12s", a.name.c_str()) + cell(a.tracked_percent, 10, 1) + cell(a.ate_m, 10, 4) +
         cell(a.ate_percent, 8, 3) + cell(a.ate_own_m, 10, 4) + cell(a.live_ate_m, 10, 4) + cell(translation, 9, 4) +
         cell(rotation, 9, 3) + cell(a.drift_m, 9, 4) + cell(a.path_m, 9, 2) + "\n";
}

// Whoever knew only the middle of the true paths would be off by their spread.
bool says_little(const Evaluation& e) {
  constexpr double kOfSpread = 0.5;
  return e.ate_m && e.truth_spread_m && *e.ate_m > kOfSpread * *e.truth_spread_m;
}

std::string headline(const Evaluation& e) {
  if (!e.ate_m) return "  no absolute error: " + e.problem + " with truth\n";
  std::string text = printed("  joint ATE %.4f m", *e.ate_m);
  if (e.ate_percent) text += printed(", %.3f %% of %.2f m", *e.ate_percent, *e.path_m);
  text += printed("; scale %.5f", e.alignment.target_from_source->scale);
  if (e.tracked_percent) text += printed("; %.1f %% of the images tracked", *e.tracked_percent);
  if (e.live_ate_m) text += printed("; live ATE %.4f m", *e.live_ate_m);
  text += "\n";
  if (says_little(e)) {
    text += printed("  this says LITTLE of where the cameras were: their true places are spread by %.4f m themselves\n",
                    *e.truth_spread_m);
  }
  return text;
}

// What became of the images that are not tracked.
std::string image_lines(const Evaluation& e) {
  std::string text;
  for (const AgentEvaluation& a : e.agents) {
    if (!a.images.losses().empty()) text += "  " + losses_of(a.name, a.images) + "\n";
  }
  return text;
}

// What the figures of the truth do not say themselves: how much they are of, and whether it is what it seems.
std::string truth_lines(const Evaluation& e) {
  constexpr double kMost = 0.9;
  std::string text;
  for (const AgentEvaluation& a : e.agents) {
    if (a.judged > 0 && a.judged < kMost * a.poses) {
      text += printed("  %s is judged on %d of %d poses, %.1f of %.1f s: for more there is no truth\n", a.name.c_str(),
                      a.judged, a.poses, a.judged_s, a.poses_s);
    }
    for (const std::string& doubt : a.doubts) text += "  " + doubt + "\n";
  }
  return text;
}

std::string lines_with_truth(const Evaluation& e) {
  std::string text = headline(e);
  text += "  agent        tracked %     ATE m  % path     own m    live m  RPE m/s  deg/s    drift m   path m\n";
  for (const AgentEvaluation& agent : e.agents) text += agent_row(agent);
  return text + image_lines(e) + truth_lines(e);
}

std::string lines_without_truth(const Evaluation& e) {
  std::string text = "  no absolute error: there is no truth; how good a path is without one, the report says\n";
  for (const AgentEvaluation& a : e.agents) {
    text += printed("  %-12s", a.name.c_str()) + cell(a.tracked_percent, 7, 1) + " % of its images tracked\n";
  }
  return text + image_lines(e);
}

std::string list_of(const AgentNames& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text;
}

std::string change_text(const GroupChange& c) {
  return printed("%.1f s ", to_seconds(c.t_ns)) + list_of(c.first) + (c.merge ? " + " : " | ") + list_of(c.second);
}

// What besides a map that is joined wrongly may keep two agents apart.
std::string why_apart(const Evaluation& e, const std::string& a, const std::string& b) {
  constexpr double kOtherUnits = 1.2;
  const auto scale_of = [&](const std::string& name) {
    const auto agent = std::ranges::find(e.agents, name, &AgentEvaluation::name);
    return agent == e.agents.end() ? std::optional<double>() : agent->own_scale;
  };
  const auto scale_a = scale_of(a), scale_b = scale_of(b);
  if (!scale_a || !scale_b || !(*scale_a > 0) || !(*scale_b > 0)) return "";
  const double ratio = std::max(*scale_a / *scale_b, *scale_b / *scale_a);
  if (ratio < kOtherUnits) return "; or their truths are not of one frame: mirrored, or with axes in another order";
  return printed("; by scale they differ %.4g times: is one truth in other units?", ratio);
}

std::string group_lines(const Evaluation& e) {
  std::string text;
  if (e.maps.size() > 1) {
    text += printed("  %d maps without a known relation; the joint figures are of the largest\n",
                    static_cast<int>(e.maps.size()));
    for (const MapEvaluation& m : e.maps) {
      text += "  map of " + list_of(m.agents) + ": ATE " + (m.ate_m ? printed("%.4f m", *m.ate_m) : "-") +
              (m.scale ? printed(", scale %.5f", *m.scale) : "") + "\n";
    }
  }
  for (const auto& [a, b] : e.wrong_merges) {
    text += printed("  WRONG MERGE: %s and %s do not fit together, though each alone follows its truth%s\n", a.c_str(),
                    b.c_str(), why_apart(e, a, b).c_str());
  }
  if (!e.groups) return text;
  const GroupScore& g = *e.groups;
  text +=
      printed("  groups: %d of %d splits and %d of %d merges found, %d false splits, %d false merges", g.found(false),
              g.count(false), g.found(true), g.count(true), g.false_count(false), g.false_count(true));
  if (const auto worst = g.worst_delay_s()) text += printed("; worst delay %.2f s", *worst);
  if (g.shortest_state_s) text += printed("; shortest state %.2f s", *g.shortest_state_s);
  text += "\n";
  for (const FollowedChange& c : g.changes) {
    text += "    " + change_text(c.change) + (c.delay_s ? printed(": %+.2f s\n", *c.delay_s) : ": missed\n");
  }
  for (const GroupChange& c : g.false_changes) text += "    " + change_text(c) + ": false\n";
  return text;
}

std::string percent(const std::optional<double>& v) { return v ? printed("%.1f %%", 100 * *v) : std::string("-"); }

std::string body_line(const std::string& name, const BodyScore& b) {
  std::string text =
      "  " + name + ": moving points at " + percent(b.coverage()) + printed(" of %d instants", b.instants);
  if (b.object_instants > 0) {
    text += "; one object at " + percent(b.object_found()) + printed(" of %d", b.object_instants);
  }
  if (const auto error = b.velocity_error_m_s()) text += printed(", its velocity %.3f m/s off", *error);
  return text + "\n";
}

std::string moving_lines(const Evaluation& e) {
  std::string text;
  if (const auto& c = e.classification) {
    text += "  moving points: precision " + percent(c->precision) + ", recall " + percent(c->recall) +
            ", taken for static " + percent(c->static_on_moving) + ", false alarms " + percent(c->false_alarm) +
            printed(" (%d observations)\n", c->observations);
  }
  if (const auto& d = e.dynamic_error_m) {
    text +=
        printed("  moving points: %.4f m median, %.4f m p90 to the marked ones (%d)\n", d->median, d->p90, d->count);
  }
  if (const auto& d = e.dynamic_surface_error_m) {
    text +=
        printed("  moving points: %.4f m median, %.4f m p90 to the true surface (%d)\n", d->median, d->p90, d->count);
  }
  if (const auto& d = e.dynamic_relative_error) {
    text += "  moving points: " + percent(d->median) + " median, " + percent(d->p90) +
            printed(" p90 of the distance to the nearest camera (%d)\n", d->count);
  }
  if (e.dynamic_length_s) text += printed("  moving points: followed for %.2f s in the median\n", *e.dynamic_length_s);
  for (const auto& [name, b] : e.bodies) text += body_line(name, b);
  if (e.bodies.size() > 1) text += body_line("all", sum_of(e.bodies));
  return text;
}

}  // namespace

std::string to_text(const Evaluation& e) {
  const bool has_truth =
      std::ranges::any_of(e.agents, [](const AgentEvaluation& a) { return a.judged > 0 || !a.doubts.empty(); });
  std::string text = e.sequence + "\n" + (has_truth ? lines_with_truth(e) : lines_without_truth(e));
  if (const auto& r = e.relative_pose) {
    text += printed("  %s to %s: %.4f m as it stands, %.4f m scaled, %.3f deg, medians of %d (true distance %.3f m)\n",
                    e.agents[0].name.c_str(), e.agents[1].name.c_str(), r->translation, r->translation_scaled,
                    r->rotation_deg, r->count, r->baseline_m);
  }
  if (const auto& p = e.points) {
    text +=
        printed("  static points: %.4f m median, %.4f m p90; NEES %.2f median, %.2f p90, ideal 2.37 and 6.25 (%d)\n",
                p->error_median_m, p->error_p90_m, p->nees_median, p->nees_p90, p->count);
  }
  return text + group_lines(e) + moving_lines(e);
}

}  // namespace coslam::eval
