// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/rates.h"

#include <algorithm>

namespace coslam {
namespace {

constexpr double kOf_s = 3.0, kLossOf_s = 10.0;  // heartbeats, with the frames that were dropped, come once a second

// Leaves the newest one that is older than that time.
template <class Sums>
void forget(std::deque<Sums>& sums, TimeNs now_ns, double of_s) {
  while (sums.size() > 2 && now_ns - sums[1].wall_ns > to_ns(of_s)) sums.pop_front();
}

}  // namespace

void Rates::see(const PublicState& state) {
  const auto whole = state.stages.find("frame_set");
  if (whole != state.stages.end()) {
    sets_.push_back({state.wall_ns, whole->second.sum, static_cast<double>(whole->second.count)});
    forget(sets_, state.wall_ns, kOf_s);
    const double sets = sets_.back().sets - (sets_.size() > 1 ? sets_.front().sets : 0);
    const double ms = sets_.back().ms - (sets_.size() > 1 ? sets_.front().ms : 0);
    if (sets > 0) ms_per_set_ = ms / sets;
  }
  for (const PublicAgent& a : state.agents) {
    auto& sums = agents_[a.facts.name];
    if (!sums.empty() && sums.back().run != a.run) sums.clear();
    const double due = static_cast<double>(a.frames_due) - static_cast<double>(a.facts.status.dropped) -
                       static_cast<double>(a.facts.status.left_out);
    sums.push_back(
        {state.wall_ns, a.run, a.facts.bytes_up, a.facts.bytes_down, due, static_cast<double>(a.frames_used)});
    forget(sums, state.wall_ns, kLossOf_s);
  }
}

Rates::Agent Rates::rate_of(const std::string& agent) const {
  const auto at = agents_.find(agent);
  if (at == agents_.end() || at->second.size() < 2) return {};
  const auto& sums = at->second;
  const Sums& now = sums.back();
  Agent out;
  const double due = now.due - sums.front().due, used = now.used - sums.front().used;
  if (due > 0) out.lost_percent = std::clamp(100 * (1 - used / due), 0.0, 100.0);
  const auto before =
      std::ranges::find_if(sums, [&](const Sums& s) { return now.wall_ns - s.wall_ns <= to_ns(kOf_s); });
  const double over_s = to_seconds(now.wall_ns - before->wall_ns);
  if (over_s <= 0) return out;
  out.bytes_up_per_s = static_cast<double>(now.bytes_up - before->bytes_up) / over_s;
  out.bytes_down_per_s = static_cast<double>(now.bytes_down - before->bytes_down) / over_s;
  return out;
}

}  // namespace coslam
