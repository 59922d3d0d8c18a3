// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/result_recorder.h"

#include <utility>

#include "common/base/log.h"
#include "server/keep/observe/run_folder.h"

namespace coslam {

ResultRecorder::ResultRecorder(ResultPlace place, const EventsConfig& events, std::function<TimeNs()> utc_ns,
                               const MapKeeper* keeper)
    : place_(std::move(place)), events_(events), utc_ns_(std::move(utc_ns)), keeper_(keeper) {}

void ResultRecorder::open(const std::filesystem::path& folder) { store_.emplace(folder_ = folder, events_); }

// A folder of the run's own waits for an agent besides, so that `latest` names a run that has something.
void ResultRecorder::idle(const ServerView& view) {
  if (store_ || !view.at_work) return;
  if (place_.runs.empty()) return open(place_.folder);
  if (!std::exchange(runs_made_, true)) make_folder_of_runs(place_.runs);
  if (view.agents == 0) return;
  open(make_run_folder(place_.runs, utc_ns_(), view.server.run()));
  link_latest(folder_);
  log_info("the result goes to " + folder_.string());
}

// The result of agents that have gone on since a server before this one begins with what that one put down.
void ResultRecorder::take_earlier_frames(const MapServer& server) {
  if (keeper_ == nullptr) return;
  for (const MapCamera& c : server.map().cameras()) {
    if (!server.met_since(c.id) || !met_.insert(c.id).second) continue;
    keeper_->for_each_past(c.id, [&](PastFrames block) {
      PastPart past;
      past.frames.push_back(std::move(block));
      store_->take(past);
    });
  }
}

void ResultRecorder::after_set(const SetOutcome& outcome, const ServerView& view) {
  if (!store_) return;
  take_earlier_frames(view.server);
  store_->take(outcome.past);
  store_->record(outcome.set, view.server);
}

void ResultRecorder::ending(const ServerView& view, const nlohmann::ordered_json& report) {
  if (store_) store_->write(view.server, report);
}

void ResultRecorder::ended(const ServerView& view, const nlohmann::ordered_json& report) {
  if (store_) store_->finish(view.server, report);
}

}  // namespace coslam
