// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/record/recording_link.h"

#include <system_error>
#include <utility>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/base/version.h"
#include "common/flow/clock.h"

namespace coslam {
namespace {

void say_ended(const std::filesystem::path& file, TimeNs t_ns, const std::string& why) {
  log_warn("the recording " + file.string() + " ends after " + format_seconds(t_ns) + " s: " + why +
           "; mapping goes on");
}

}  // namespace

Recorder::Recorder(const std::filesystem::path& file, RecordingHead head)
    : file_(file), writer_(file), monotonic_ns_(monotonic_now_ns()) {
  head.version = version();
  head.monotonic_ns = monotonic_ns_;
  head.utc_ns = time_of_day_ns();
  if (const int error = writer_.write(encode_head(head))) {
    writer_.remove();
    throw UserError(file.string() + ": cannot be written: " + std::generic_category().message(error));
  }
  worker_.emplace("recorder", [this](const std::stop_token&) { write_items(); });
}

Recorder::~Recorder() {
  queue_.close();
  worker_->join();
  if (!any_event_) writer_.remove();
}

TimeNs Recorder::now_ns() const { return monotonic_now_ns() - monotonic_ns_; }

void Recorder::add(ServerEvent event, TimeNs t_ns) { push({std::move(event), t_ns}); }

void Recorder::end() {
  push({std::nullopt, now_ns()});
  over_ = true;
  queue_.close();
}

void Recorder::push(Item item) {
  const TimeNs t_ns = item.t_ns;
  if (over_ || queue_.push(std::move(item)) || over_.exchange(true)) return;
  queue_.close();  // what it holds is still written
  say_ended(file_, t_ns, "the disk is too slow");
}

void Recorder::write_items() {
  while (auto item = queue_.pop()) {
    const Record record =
        item->event ? encode_event(*item->event, item->t_ns) : Record{RecordType::kEnd, item->t_ns, {}};
    const int error = writer_.write(record);
    if (error != 0) {
      if (!over_.exchange(true)) say_ended(file_, item->t_ns, std::generic_category().message(error));
      queue_.close();
      return;
    }
    any_event_ |= item->event.has_value();
  }
}

std::optional<ServerEvent> RecordingLink::next_event(std::chrono::milliseconds timeout) {
  auto event = link_.next_event(timeout);
  if (!event) {
    taken_ns_.reset();
    return event;
  }
  if (!taken_ns_) taken_ns_ = recorder_.now_ns();
  recorder_.add(*event, *taken_ns_);
  return event;
}

}  // namespace coslam
