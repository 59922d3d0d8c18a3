// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <set>

#include "common/base/time.h"
#include "server/keep/map_keeper.h"
#include "server/keep/observe/result_store.h"
#include "server/keep/set_observer.h"

namespace coslam {

// Destination of a run's result; both empty: none.
struct ResultPlace {
  std::filesystem::path folder;  // the RESULT folder itself
  std::filesystem::path runs;    // or where to make one for this run, when its first agent has joined
  bool none() const { return folder.empty() && runs.empty(); }
};

// Records the RESULT folder of a server at work. The folder is not made before the server is at work: a server that is
// refused for its domain touches nothing.
class ResultRecorder final : public SetObserver {
 public:
  // keeper: has what cameras did before this server, and outlives this; null: there is no map file.
  ResultRecorder(ResultPlace place, const EventsConfig& events, std::function<TimeNs()> utc_ns,
                 const MapKeeper* keeper);

  // The RESULT folder; empty: not made yet.
  const std::filesystem::path& folder() const { return folder_; }

  bool wants_journal() const override { return events_.enabled; }
  void after_set(const SetOutcome& outcome, const ServerView& view) override;
  void idle(const ServerView& view) override;
  void ending(const ServerView& view, const nlohmann::ordered_json& report) override;
  void ended(const ServerView& view, const nlohmann::ordered_json& report) override;

 private:
  void open(const std::filesystem::path& folder);
  void take_earlier_frames(const MapServer& server);

  const ResultPlace place_;
  const EventsConfig events_;
  const std::function<TimeNs()> utc_ns_;
  const MapKeeper* const keeper_;
  bool runs_made_ = false;
  std::filesystem::path folder_;
  std::optional<ResultStore> store_;
  std::set<CameraId> met_;  // cameras whose frames of before this server were looked for
};

}  // namespace coslam
