// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/dataset/result.h"

// Whether the reported groups follow the true overlap of the views.
namespace coslam::eval {

using AgentNames = std::set<std::string>;
// Each agent is in exactly one of the sets.
using Partition = std::set<AgentNames>;

// Event of two parts becoming one, or one falling in two.
struct GroupChange {
  TimeNs t_ns = 0;
  bool merge = false;
  AgentNames first, second;
};

// Changes from one partition to the next: splits, then merges. An agent that is missing in one of them is alone there.
std::vector<GroupChange> changes_between(const Partition& before, const Partition& after, TimeNs t_ns);

// Share of agent a's view at an instant that agent b sees too.
struct OverlapRow {
  TimeNs t_ns = 0;
  std::string a, b;
  double share = 0;
};
// `t_s,agent_a,agent_b,share`; throws UserError with file and line.
std::vector<OverlapRow> read_overlap(const std::filesystem::path& file);

// The true overlap of views. Two agents surely do see the same when each sees the share kLinked or more of the other's
// view, and surely not when neither sees more than the share kApart; between these either answer is right.
class TrueOverlap {
 public:
  static constexpr double kLinked = 0.15, kApart = 0.04;

  explicit TrueOverlap(const std::vector<OverlapRow>& rows);

  struct Change : GroupChange {
    TimeNs from_ns = 0;  // start of the time until t_ns in which either answer was right
  };
  // Changes of the components, where a link lasts from kLinked until kApart.
  std::vector<Change> changes() const;
  // Whether an agent of one set sees the same as one of the other, directly or over others: possibly, at any time of a
  // span; surely, all the time.
  bool possibly_joined(const AgentNames& a, const AgentNames& b, TimeNs from_ns, TimeNs to_ns) const;
  bool surely_joined(const AgentNames& a, const AgentNames& b, TimeNs from_ns, TimeNs to_ns) const;

 private:
  struct Instant {
    TimeNs t_ns = 0;
    Partition surely, possibly, held;  // components of the links
  };
  std::vector<Instant> instants_;
};

struct FollowedChange {
  TrueOverlap::Change change;
  std::optional<double> delay_s;  // 0: while either answer was right; negative: before; empty: not reported
};

struct GroupScore {
  std::vector<FollowedChange> changes;
  std::vector<GroupChange> false_changes;  // reported, with no reason within a second
  std::optional<double> shortest_state_s;  // between two changes of the report, once all agents are in it

  int count(bool merge) const;
  int found(bool merge) const;
  int false_count(bool merge) const;
  std::optional<double> worst_delay_s() const;  // delay with the largest magnitude
};

// The report as it was from each time on.
using ReportedGroups = std::map<TimeNs, Partition>;
ReportedGroups reported_groups(const std::vector<ResultGroupRow>& rows);

GroupScore score_groups(const ReportedGroups& reported, const TrueOverlap& truth);

// Agents that were ever in one group, over others or directly: they share a map.
Partition maps_of(const ReportedGroups& reported);

}  // namespace coslam::eval
