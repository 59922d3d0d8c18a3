// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/map_keeper.h"

#include <chrono>
#include <iterator>
#include <string>
#include <utility>

#include "common/base/log.h"
#include "common/flow/clock.h"
#include "server/estimator/map/validate.h"

namespace coslam {

MapKeeper::MapKeeper(const std::filesystem::path& file, const KeepConfig& config, MapServer* server)
    : config_(config),
      server_(*server),
      file_(file, MapFile::Access::kWrite),
      saved_at_ns_(monotonic_now_ns()),
      saver_([this](const std::vector<Row>& rows) { file_.write(rows, time_of_day_ns()); }) {
  const Tables tables = file_.read();
  if (tables.empty()) return;
  server_.restore(tables, to_seconds(time_of_day_ns() - file_.saved_ns().value_or(0)), file_.version());
  times_fit_ = false;
  log_info("going on with the map of " + file.string() + ": " + std::to_string(server_.map().points().size()) +
           " points, " + std::to_string(server_.map().cameras().size()) + " cameras");
}

std::optional<TimeNs> MapKeeper::date_now_ns() const {
  if (!server_.restored_until()) return std::nullopt;
  return server_.map().now_ns() + time_of_day_ns() - file_.saved_ns().value_or(0);
}

void MapKeeper::before_frame(TimeNs capture_ns) {
  constexpr double kBetween_s = 1;  // the clocks of agents that start together differ by less
  if (std::exchange(times_fit_, true)) return;
  const TimeNs last_ns = server_.map().now_ns();
  if (capture_ns <= last_ns) server_.shift_times(capture_ns - to_ns(kBetween_s) - last_ns);
}

void MapKeeper::after_set(const SetOutcome& outcome, const ServerView& /*view*/) {
  take(outcome.past);
  pass_words();
  const TimeNs now_ns = monotonic_now_ns();
  if (now_ns - saved_at_ns_ < to_ns(config_.period_s) || !saver_.idle()) return;
  saved_at_ns_ = now_ns;
  save();
}

void MapKeeper::take(const PastPart& past) {
  std::vector<Row> rows = rows_of(past);
  past_rows_.insert(past_rows_.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
}

void MapKeeper::for_each_past(CameraId camera, const std::function<void(PastFrames)>& visit) const {
  const auto [first, last] = past_frames_rows_of(camera);
  file_.for_each_row(kPastFramesTable, first, last, [&](const std::string& octets) {
    PastFrames block = past_frames_of(octets);
    validate(block, server_.map());
    visit(std::move(block));
  });
}

void MapKeeper::save() {
  std::vector<Row> rows = server_.changed_rows();
  rows.insert(rows.end(), std::make_move_iterator(past_rows_.begin()), std::make_move_iterator(past_rows_.end()));
  past_rows_.clear();
  saver_.give(std::move(rows));
}

void MapKeeper::pass_words() {
  while (const auto word = saver_.accept_agent_pose()) log_warn(*word);
}

void MapKeeper::ending(const ServerView& /*view*/, const nlohmann::ordered_json& /*report*/) {
  constexpr auto kPatience = std::chrono::seconds(20);
  save();
  saver_.finish(kPatience);
  pass_words();
}

}  // namespace coslam
