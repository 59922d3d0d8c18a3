// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "common/dataset/result.h"

// events.csv of a RESULT folder: what changed in the structure of the map, and why, in the order in which it happened.
namespace coslam {

// Texts belong to whoever made the row. What does not apply to a kind of event is 0, empty, or absent.
struct EventRow {
  TimeNs t_ns = 0;
  SetId set;
  std::string_view kind, why;
  MapId map, from;
  PointId point, other;
  std::string_view camera;  // the agent's name
  TrackId track;
  std::string_view to;  // new state
  std::optional<double> a, b;
};

// The kind of the last row of a whole file. A file without it is still written, or was cut off.
inline constexpr std::string_view kEventsEnd = "end";

class EventWriter : public CsvWriter {
 public:
  explicit EventWriter(const std::filesystem::path& file);
  void write(const EventRow& row);
  std::uintmax_t bytes() const { return file_.bytes(); }
  // Takes back the rows after the first `bytes`.
  void cut(std::uintmax_t bytes) { file_.cut(bytes); }
};

struct EventFileReport {
  long rows = 0;
  bool cut = false;  // the last line is a part of one, which was left out
};

// Calls `row` for each line, whose texts last as long as the call; false from it ends with an error that names the
// line. Throws UserError with file and line.
EventFileReport for_each_event_row(const std::filesystem::path& file, const std::function<bool(const EventRow&)>& row);

}  // namespace coslam
