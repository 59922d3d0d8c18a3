// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/record/recording.h"

#include <utility>
#include <variant>

#include "common/base/error.h"

namespace coslam {

Recording::Recording(const std::filesystem::path& file) : reader_(file) {
  const auto record = reader_.next();
  if (!record) throw UserError(file.string() + ": the recording was cut off before anything was recorded");
  if (const auto foreign = foreign_protocol(*record)) throw UserError(file.string() + " " + *foreign);
  auto head = decode_head(*record);
  if (!head) reader_.fail("is no head of a recording");
  head_ = std::move(*head);
}

std::optional<TimedEvent> Recording::next() {
  if (over_) return std::nullopt;
  auto record = reader_.next();
  if (record) t_ns_ = record->t_ns;
  ended_ = record && record->type == RecordType::kEnd;
  over_ = !record || ended_;
  if (over_) return std::nullopt;
  auto event = decode_event(*record);
  if (!event || !in_order(*event)) reader_.fail("is not one that coslam writes");
  return TimedEvent{record->t_ns, std::move(*event)};
}

// As a link delivers them: nothing of a run before its Hello, frames ascending.
bool Recording::in_order(const ServerEvent& event) {
  if (const auto* hello = std::get_if<Hello>(&event)) runs_[hello->agent_run] = {hello->agent, {}};
  const auto* joined = std::get_if<JoinedFrame>(&event);
  if (joined == nullptr) return true;
  const auto run = runs_.find(joined->frame.agent_run);
  if (run == runs_.end() || run->second.agent != joined->frame.agent) return false;
  const auto before = std::exchange(run->second.last, joined->frame.frame);
  return !before || *before < joined->frame.frame;
}

RecordingSummary check_recording(const std::filesystem::path& file) {
  Recording recording(file);
  while (recording.next()) {
  }
  return {recording.head(), recording.t_ns(), recording.cut_off()};
}

}  // namespace coslam
