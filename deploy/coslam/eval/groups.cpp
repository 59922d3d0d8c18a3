// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/groups.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <utility>

#include "common/base/error.h"
#include "common/base/text.h"

namespace coslam::eval {
namespace {

using Link = std::pair<std::string, std::string>;

AgentNames agents_of(const Partition& partition) {
  AgentNames out;
  for (const AgentNames& part : partition) out.insert(part.begin(), part.end());
  return out;
}

Partition with_missing(Partition partition, const AgentNames& all) {
  const AgentNames present = agents_of(partition);
  for (const std::string& agent : all) {
    if (!present.contains(agent)) partition.insert({agent});
  }
  return partition;
}

AgentNames common(const AgentNames& a, const AgentNames& b) {
  AgentNames out;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::inserter(out, out.end()));
  return out;
}

bool joined(const Partition& partition, const AgentNames& a, const AgentNames& b) {
  return std::any_of(partition.begin(), partition.end(),
                     [&](const AgentNames& part) { return !common(part, a).empty() && !common(part, b).empty(); });
}

// Sets that have an agent in common become one.
Partition united(const std::vector<AgentNames>& sets) {
  Partition out;
  for (AgentNames next : sets) {
    for (auto part = out.begin(); part != out.end();) {
      if (common(*part, next).empty()) {
        ++part;
        continue;
      }
      next.insert(part->begin(), part->end());
      part = out.erase(part);
    }
    out.insert(std::move(next));
  }
  return out;
}

Partition components(const AgentNames& agents, const std::set<Link>& links) {
  std::vector<AgentNames> sets;
  for (const std::string& agent : agents) sets.push_back({agent});
  for (const auto& [a, b] : links) sets.push_back({a, b});
  return united(sets);
}

// The parts of each set of `whole`, one change for every part but its first.
void add_changes(const Partition& whole, const Partition& parts, bool merge, TimeNs t_ns,
                 std::vector<GroupChange>* out) {
  for (const AgentNames& set : whole) {
    AgentNames so_far;
    for (const AgentNames& part : parts) {
      const AgentNames inside = common(set, part);
      if (inside.empty()) continue;
      if (!so_far.empty()) out->push_back({t_ns, merge, so_far, inside});
      so_far.insert(inside.begin(), inside.end());
    }
  }
}

// How late the report made a change; of several times, the nearest.
std::optional<double> delay_of(const TrueOverlap::Change& change, const ReportedGroups& reported) {
  constexpr TimeNs kEarliest_ns = 3'000'000'000, kLatest_ns = 10'000'000'000;
  std::optional<double> nearest_s;
  bool was_joined = false;
  for (const auto& [t_ns, partition] : reported) {
    const bool is_joined = joined(partition, change.first, change.second);
    const bool turned = is_joined != was_joined && is_joined == change.merge;
    was_joined = is_joined;
    if (!turned || t_ns < change.from_ns - kEarliest_ns || t_ns > change.t_ns + kLatest_ns) continue;
    double delay_s = 0;
    if (t_ns < change.from_ns) delay_s = to_seconds(t_ns - change.from_ns);
    if (t_ns > change.t_ns) delay_s = to_seconds(t_ns - change.t_ns);
    if (!nearest_s || std::abs(delay_s) < std::abs(*nearest_s)) nearest_s = delay_s;
  }
  return nearest_s;
}

bool has_no_reason(const GroupChange& change, const TrueOverlap& truth) {
  constexpr TimeNs kGrace_ns = 1'000'000'000;
  const TimeNs from_ns = change.t_ns - kGrace_ns, to_ns = change.t_ns + kGrace_ns;
  if (change.merge) return !truth.possibly_joined(change.first, change.second, from_ns, to_ns);
  return truth.surely_joined(change.first, change.second, from_ns, to_ns);
}

}  // namespace

std::vector<GroupChange> changes_between(const Partition& before, const Partition& after, TimeNs t_ns) {
  AgentNames all = agents_of(before);
  all.merge(agents_of(after));
  const Partition from = with_missing(before, all), to = with_missing(after, all);
  Partition parts;  // what is together in both
  for (const AgentNames& a : from) {
    for (const AgentNames& b : to) {
      AgentNames part = common(a, b);
      if (!part.empty()) parts.insert(std::move(part));
    }
  }
  std::vector<GroupChange> out;
  add_changes(from, parts, false, t_ns, &out);
  add_changes(to, parts, true, t_ns, &out);
  return out;
}

std::vector<OverlapRow> read_overlap(const std::filesystem::path& file) {
  constexpr std::string_view kHeader = "t_s,agent_a,agent_b,share";
  std::ifstream stream(file);
  if (!stream) throw UserError(file.string() + ": cannot be read");
  std::vector<OverlapRow> rows;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#' || text == kHeader) continue;
    const auto fields = split_csv(text);
    const auto t_ns = fields.size() == 4 ? parse_seconds(fields[0]) : std::nullopt;
    const auto share = fields.size() == 4 ? parse_double(fields[3]) : std::nullopt;
    if (!t_ns || !share) {
      throw UserError(file.string() + ":" + std::to_string(number) + ": not a line `" + std::string(kHeader) + "`");
    }
    rows.push_back({*t_ns, std::string(fields[1]), std::string(fields[2]), *share});
  }
  return rows;
}

TrueOverlap::TrueOverlap(const std::vector<OverlapRow>& rows) {
  struct Shares {
    double least = 1, most = 0;
  };
  std::map<TimeNs, std::map<Link, Shares>> by_time;
  AgentNames agents;
  for (const OverlapRow& row : rows) {
    agents.insert({row.a, row.b});
    Shares& shares = by_time[row.t_ns][std::minmax(row.a, row.b)];
    shares.least = std::min(shares.least, row.share);
    shares.most = std::max(shares.most, row.share);
  }
  std::set<Link> held;
  for (const auto& [t_ns, links] : by_time) {
    std::set<Link> surely, possibly;
    for (const auto& [link, shares] : links) {
      if (shares.least >= kLinked) surely.insert(link);
      if (shares.most > kApart) possibly.insert(link);
    }
    std::erase_if(held, [&](const Link& link) { return !possibly.contains(link); });
    held.insert(surely.begin(), surely.end());
    instants_.push_back({t_ns, components(agents, surely), components(agents, possibly), components(agents, held)});
  }
}

std::vector<TrueOverlap::Change> TrueOverlap::changes() const {
  std::vector<Change> out;
  for (std::size_t i = 1; i < instants_.size(); ++i) {
    for (const GroupChange& c : changes_between(instants_[i - 1].held, instants_[i].held, instants_[i].t_ns)) {
      std::size_t from = i;
      while (from > 1 && joined(c.merge ? instants_[from - 1].possibly : instants_[from - 1].surely, c.first,
                                c.second) == c.merge) {
        --from;
      }
      out.push_back({c, instants_[from].t_ns});
    }
  }
  return out;
}

bool TrueOverlap::possibly_joined(const AgentNames& a, const AgentNames& b, TimeNs from_ns, TimeNs to_ns) const {
  return std::any_of(instants_.begin(), instants_.end(), [&](const Instant& i) {
    return i.t_ns >= from_ns && i.t_ns <= to_ns && joined(i.possibly, a, b);
  });
}

bool TrueOverlap::surely_joined(const AgentNames& a, const AgentNames& b, TimeNs from_ns, TimeNs to_ns) const {
  return std::all_of(instants_.begin(), instants_.end(),
                     [&](const Instant& i) { return i.t_ns < from_ns || i.t_ns > to_ns || joined(i.surely, a, b); });
}

int GroupScore::count(bool merge) const {
  return static_cast<int>(
      std::count_if(changes.begin(), changes.end(), [&](const FollowedChange& c) { return c.change.merge == merge; }));
}

int GroupScore::found(bool merge) const {
  return static_cast<int>(std::count_if(changes.begin(), changes.end(), [&](const FollowedChange& c) {
    return c.change.merge == merge && c.delay_s.has_value();
  }));
}

int GroupScore::false_count(bool merge) const {
  return static_cast<int>(std::count_if(false_changes.begin(), false_changes.end(),
                                        [&](const GroupChange& c) { return c.merge == merge; }));
}

std::optional<double> GroupScore::worst_delay_s() const {
  std::optional<double> worst;
  for (const FollowedChange& c : changes) {
    if (c.delay_s && (!worst || std::abs(*c.delay_s) > std::abs(*worst))) worst = c.delay_s;
  }
  return worst;
}

ReportedGroups reported_groups(const std::vector<ResultGroupRow>& rows) {
  ReportedGroups out;
  for (const ResultGroupRow& row : rows) out[row.t_ns].insert(AgentNames(row.agents.begin(), row.agents.end()));
  return out;
}

GroupScore score_groups(const ReportedGroups& reported, const TrueOverlap& truth) {
  GroupScore score;
  for (const TrueOverlap::Change& change : truth.changes())
    score.changes.push_back({change, delay_of(change, reported)});
  AgentNames all;
  for (const auto& [t_ns, partition] : reported) all.merge(agents_of(partition));
  Partition before;
  std::optional<TimeNs> changed_ns;
  bool complete = false;
  for (const auto& [t_ns, partition] : reported) {
    const auto changes = changes_between(before, partition, t_ns);
    std::copy_if(changes.begin(), changes.end(), std::back_inserter(score.false_changes),
                 [&](const GroupChange& c) { return has_no_reason(c, truth); });
    if (complete && !changes.empty()) {
      if (changed_ns) {
        const double state_s = to_seconds(t_ns - *changed_ns);
        score.shortest_state_s = std::min(score.shortest_state_s.value_or(state_s), state_s);
      }
      changed_ns = t_ns;
    }
    complete = complete || agents_of(partition) == all;
    before = partition;
  }
  return score;
}

Partition maps_of(const ReportedGroups& reported) {
  std::vector<AgentNames> sets;
  for (const auto& [t_ns, partition] : reported) sets.insert(sets.end(), partition.begin(), partition.end());
  return united(sets);
}

}  // namespace coslam::eval
