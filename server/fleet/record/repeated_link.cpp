// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/record/repeated_link.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "common/base/error.h"

namespace coslam {
namespace {

// When it was taken, for what has a time of its own.
std::optional<TimeNs> played_ns(const ServerEvent& event) {
  const auto* joined = std::get_if<JoinedFrame>(&event);
  return joined == nullptr ? std::nullopt : std::optional(joined->frame.capture_ns);
}

std::string name_in(int fleet, const std::string& agent) {
  return fleet == 0 ? agent : agent + "-" + std::to_string(fleet + 1);
}

// Another one for each fleet and time; never 0.
RunId run_in(int fleet, int time, RunId recorded) {
  const auto mark = static_cast<std::uint64_t>(fleet) << 32U | static_cast<std::uint64_t>(time);
  return mark == 0 ? recorded : RunId((recorded.value ^ (mark * 0x9e3779b97f4a7c15U)) | 1U);
}

}  // namespace

RepeatedLink::RepeatedLink(const std::filesystem::path& file, const Repeats& repeats) : file_(file), repeats_(repeats) {
  constexpr TimeNs kGrid_ns = 100'000'000;  // whole frames at the usual rates: all fleets' images are of one instant
  const auto on_grid = [](TimeNs t_ns) { return (t_ns + kGrid_ns - 1) / kGrid_ns * kGrid_ns; };
  Recording all(file);
  head_ = all.head();
  std::optional<TimeNs> first_ns, last_ns;
  while (const auto event = all.next()) {
    const auto t_ns = played_ns(event->event);
    if (!t_ns) continue;
    first_ns = std::min(first_ns.value_or(*t_ns), *t_ns);
    last_ns = std::max(last_ns.value_or(*t_ns), *t_ns);
  }
  if (!first_ns) throw UserError(file.string() + " has no frame");
  first_ns_ = *first_ns;
  period_ns_ = on_grid(*last_ns - *first_ns + to_ns(repeats.pause_s));
  for (int i = 0; i < repeats.fleets; ++i) {
    Fleet& fleet = fleets_.emplace_back();
    fleet.number = i;
    fleet.begins_ns = on_grid(i * period_ns_ / repeats.fleets);
    begin(fleet);
  }
}

TimeNs RepeatedLink::length_ns() const { return period_ns_ * (repeats_.times + 1); }

bool RepeatedLink::over() const {
  return std::ranges::all_of(fleets_, [](const Fleet& f) { return !f.next; });
}

void RepeatedLink::begin(Fleet& fleet) {
  fleet.recording = std::make_unique<Recording>(file_);
  fleet.due_ns = fleet.begins_ns;
  take_next(fleet);
}

// What has no time of its own comes right after what was before it.
void RepeatedLink::take_next(Fleet& fleet) {
  fleet.next = fleet.recording->next();
  if (!fleet.next && ++fleet.time < repeats_.times) {
    fleet.begins_ns += period_ns_;
    begin(fleet);
    return;
  }
  if (!fleet.next) return;
  if (const auto t_ns = played_ns(fleet.next->event))
    fleet.due_ns = std::max(fleet.due_ns, fleet.begins_ns + *t_ns - first_ns_);
}

ServerEvent RepeatedLink::as_of(const Fleet& fleet, ServerEvent event) const {
  std::visit(
      [&](auto& e) {
        using Event = std::decay_t<decltype(e)>;
        if constexpr (std::is_same_v<Event, JoinedFrame>) {
          e.frame.agent = name_in(fleet.number, e.frame.agent);
          e.frame.agent_run = run_in(fleet.number, fleet.time, e.frame.agent_run);
          e.frame.capture_ns += fleet.begins_ns - first_ns_;
        } else {
          e.agent = name_in(fleet.number, e.agent);
          e.agent_run = run_in(fleet.number, fleet.time, e.agent_run);
        }
      },
      event);
  return event;
}

std::optional<ServerEvent> RepeatedLink::next_event(std::chrono::milliseconds timeout) {
  Fleet* first = nullptr;
  for (Fleet& f : fleets_) {
    if (f.next && (first == nullptr || f.due_ns < first->due_ns)) first = &f;
  }
  if (first == nullptr) return std::nullopt;
  if (first->due_ns > now_ns_) {
    if (timeout.count() == 0) return std::nullopt;
    now_ns_ = std::min(first->due_ns, now_ns_ + TimeNs{1'000'000} * timeout.count());
    if (first->due_ns > now_ns_) return std::nullopt;
  }
  ServerEvent event = as_of(*first, std::move(first->next->event));
  take_next(*first);
  return event;
}

}  // namespace coslam
