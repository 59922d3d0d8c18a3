// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/snapshot_observer.h"

#include <chrono>
#include <ctime>
#include <utility>

#include "common/flow/clock.h"

namespace coslam {
namespace {

// Processor time of this thread: when others displace it, that is not what telling costs.
std::chrono::nanoseconds processor_time() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec);
}

}  // namespace

SnapshotObserver::SnapshotObserver(const MapServer& server, std::vector<PublicSink*> sinks)
    : watch_(server), publication_(std::move(sinks)) {}

void SnapshotObserver::tell(Snapshot snapshot) {
  if (!snapshot.empty()) publication_.put(std::move(snapshot));
}

// With what telling takes of the map's thread.
LoopFacts SnapshotObserver::facts(const ServerView& view) const {
  LoopFacts out = view.facts();
  for (const auto& [name, h] : times_.stages()) out.watching = stage_time_of(h);
  for (AgentFacts& agent : out.agents) {
    const auto settled = view.server.path_error(agent.camera);
    const auto path = settled ? settled : paths_.path_error(agent.camera);
    if (path) agent.path = verdict_of(view.server.map().camera(agent.camera), *path, agent.images);
  }
  return out;
}

void SnapshotObserver::after_set(const SetOutcome& outcome, const ServerView& view) {
  const auto before = processor_time();
  tell(watch_.after_set(outcome.set, view.server, publication_.wanted(), monotonic_now_ns(),
                        [&] { return facts(view); }));
  if (publication_.wanted().has(Part::kState)) paths_.look(view.server, std::chrono::steady_clock::now());
  times_.add("view", processor_time() - before);
}

void SnapshotObserver::idle(const ServerView& view) {
  tell(watch_.in_between(view.server, publication_.wanted(), monotonic_now_ns(), [&] { return facts(view); }));
}

void SnapshotObserver::ending(const ServerView& view, const nlohmann::ordered_json& /*report*/) {
  tell(watch_.at_the_end(view.server, publication_.wanted(), monotonic_now_ns(), [&] { return facts(view); }));
}

}  // namespace coslam
