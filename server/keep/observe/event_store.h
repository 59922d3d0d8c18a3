// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "common/dataset/event_file.h"
#include "server/estimator/map/journal.h"
#include "server/estimator/map/map.h"

namespace coslam {

struct EventsConfig {
  bool enabled = true;
  double most_mb = 256;
};

template <class V>
void describe(V& v, EventsConfig& c) {
  v.field("enabled", c.enabled, "write events.csv, what coslam explain reads");
  v.field("most_mb", c.most_mb, {0.001, 100000}, "of it; what happens after that is not kept");
}

// Writes the journal to events.csv, set by set, up to its bound.
class EventStore {
 public:
  // Begins the file. Throws UserError.
  EventStore(const std::filesystem::path& file, const EventsConfig& config);

  // Events of one frame set; those noted before it began are dated with it.
  void record(SetId set, TimeNs t_ns, const Journal& journal, const Map& map);
  // Ends the file for now, so that it is whole whatever becomes of this process. Throws UserError when something could
  // not be written.
  void end_for_now();
  // The rest of the journal, in place of that end. Throws UserError likewise.
  void finish(const Journal& journal, const Map& map);

  // A sentence for the log, once, when the bound was reached or something could not be written.
  std::optional<std::string> take_warning();

 private:
  void write(const Event& event, const Map& map);
  void end(std::string_view why);

  EventsConfig config_;
  std::optional<EventWriter> writer_;
  SetId set_;
  TimeNs t_ns_ = 0;
  bool ended_ = false;
  std::optional<std::uintmax_t> goes_on_at_;  // position of the provisional end
  std::optional<std::string> warning_;
};

}  // namespace coslam
