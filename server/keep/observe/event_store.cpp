// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/event_store.h"

#include <cstdio>
#include <utility>

namespace coslam {
namespace {

constexpr double kBytesPerMb = 1e6;
constexpr std::uintmax_t kLongestLine = 200;

// Only figures that the reason speaks of.
std::optional<double> figure(const Event& e, std::size_t i) {
  const char* name = i == 0 ? "{a}" : "{b}";
  if (text_of(e.why).clause.find(name) == std::string_view::npos) return std::nullopt;
  return e.figures[i];
}

}  // namespace

EventStore::EventStore(const std::filesystem::path& file, const EventsConfig& config) : config_(config) {
  if (config.enabled) writer_.emplace(file);
}

void EventStore::record(SetId set, TimeNs t_ns, const Journal& journal, const Map& map) {
  set_ = set;
  t_ns_ = t_ns;
  for (Event e : journal.events()) {
    e.set = set;
    e.t_ns = t_ns;
    write(e, map);
  }
}

void EventStore::end_for_now() {
  if (!writer_) return;
  if (!ended_) {
    goes_on_at_ = writer_->bytes();
    end("run_is_over");
  }
  writer_->check();
}

void EventStore::finish(const Journal& journal, const Map& map) {
  if (!writer_) return;
  if (goes_on_at_) {
    writer_->cut(*goes_on_at_);
    ended_ = false;
  }
  for (const Event& e : journal.events()) write(e, map);
  if (!ended_) end("run_is_over");
  writer_->close();
}

std::optional<std::string> EventStore::take_warning() {
  if (warning_) return std::exchange(warning_, std::nullopt);
  auto problem = writer_ ? writer_->take_problem() : std::nullopt;
  if (problem) *problem += what_becomes_of(writer_->ended());
  return problem;
}

void EventStore::write(const Event& e, const Map& map) {
  if (!writer_ || ended_) return;
  EventRow row{.t_ns = e.t_ns,
               .set = e.set,
               .kind = name_of(e.kind),
               .why = text_of(e.why).name,
               .map = e.map,
               .from = e.from,
               .point = e.point,
               .other = e.other,
               .track = e.track,
               .to = name_of_state(e.kind, e.to),
               .a = figure(e, 0),
               .b = figure(e, 1)};
  if (e.camera) row.camera = map.camera(*e.camera).name;
  writer_->write(row);
  const double bytes = static_cast<double>(writer_->bytes() + 2 * kLongestLine);  // another one and the last
  if (bytes < config_.most_mb * kBytesPerMb) return;
  end("file_is_full");
  char most[32];
  std::snprintf(most, sizeof most, "%g", config_.most_mb);
  warning_ = "events.csv holds the " + std::string(most) +
             " MB of server.events.most_mb: what happens from now on cannot be explained";
}

void EventStore::end(std::string_view why) {
  writer_->write({.t_ns = t_ns_, .set = set_, .kind = kEventsEnd, .why = why});
  ended_ = true;
}

}  // namespace coslam
