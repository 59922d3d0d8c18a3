// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "common/base/time.h"
#include "server/estimator/map_server.h"
#include "server/keep/set_observer.h"
#include "server/keep/store/map_file.h"
#include "server/keep/store/saver.h"

namespace coslam {

struct KeepConfig {
  double period_s = 1.0;  // between savings; what is not saved yet is lost with the server
};

template <class V>
void describe(V& v, KeepConfig& c) {
  v.field("period_s", c.period_s, {0.1, 3600}, "between savings of the map file; what came later is lost by a crash");
}

// Keeps a server's map in a file, and starts it with what is there. Of the map thread.
class MapKeeper final : public SetObserver {
 public:
  // Throws UserError when the file cannot be used; it is not changed then.
  MapKeeper(const std::filesystem::path& file, const KeepConfig& config, MapServer* server);

  // Present date of the frames of agents that have gone on since the map was saved; empty without a map.
  std::optional<TimeNs> date_now_ns() const;

  // To be called before the first frame of each set is given to the server: times begin anew with a recording that is
  // played again, but in a map they only grow.
  void before_frame(TimeNs capture_ns);
  // Visits the frames in the file of a camera that left memory before this server began, in the order of time.
  void for_each_past(CameraId camera, const std::function<void(PastFrames)>& visit) const;
  // Keeps what left the map's memory, which only the file has then; saves when it is time and the disk is not behind.
  void after_set(const SetOutcome& outcome, const ServerView& view) override;
  // Saves all that is left. Throws UserError when not all could be saved.
  void ending(const ServerView& view, const nlohmann::ordered_json& report) override;
  void ended(const ServerView& view, const nlohmann::ordered_json& report) override { ending(view, report); }

 private:
  void take(const PastPart& past);
  void save();
  void pass_words();

  const KeepConfig config_;
  MapServer& server_;
  MapFile file_;
  std::vector<Row> past_rows_;  // since it was saved
  bool times_fit_ = true;
  TimeNs saved_at_ns_;
  Saver saver_;  // last: stops first
};

}  // namespace coslam
