// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "common/flow/bounded_queue.h"
#include "common/flow/worker.h"
#include "server/fleet/link/server_link.h"
#include "server/fleet/record/recorded_event.h"
#include "server/fleet/record/recording_file.h"

namespace coslam {

// Writes events to a file, in a thread of its own. The first thing that goes wrong (a full disk, one that is too slow)
// is one warning and the end of the recording. Of the thread that adds.
class Recorder {
 public:
  static constexpr std::size_t kQueue = 1024;  // events; three seconds of twelve agents at 30 Hz

  // head: its version and times are set here. Throws UserError when the file is there already or cannot be made.
  Recorder(const std::filesystem::path& file, RecordingHead head);
  // Waits until all is written. A recording without any event is removed.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  TimeNs now_ns() const;  // since the recording began
  // Adds an event; neither this nor end() ever waits for the disk.
  void add(ServerEvent event, TimeNs t_ns);
  void end();  // ends the recording; events added later are ignored

 private:
  struct Item {
    std::optional<ServerEvent> event;  // empty: end of the recording
    TimeNs t_ns = 0;
  };
  void push(Item item);
  void write_items();

  const std::filesystem::path file_;
  RecordWriter writer_;
  TimeNs monotonic_ns_ = 0;  // when it began
  BoundedQueue<Item> queue_{kQueue, QueuePolicy::kRefuse};
  std::atomic<bool> over_{false};
  bool any_event_ = false;        // written; of the worker until it was joined
  std::optional<Worker> worker_;  // last: uses what is above
};

// A link whose events are recorded as the map thread takes them. Events that are taken at once, without the link being
// empty in between, have one time, so that a replay gives them at once too.
class RecordingLink : public ServerLink {
 public:
  // The link outlives this object. The rest as for a Recorder.
  RecordingLink(ServerLink& link, const std::filesystem::path& file, RecordingHead head)
      : link_(link), recorder_(file, std::move(head)) {}

  void end() { recorder_.end(); }  // ends the recording; events taken later are not in it
  std::optional<ServerEvent> next_event(std::chrono::milliseconds timeout) override;
  bool at_work() const override { return link_.at_work(); }
  std::string join_options() const override { return link_.join_options(); }
  void send(const ServerMessage& message) override { link_.send(message); }
  bool public_wanted() const override { return link_.public_wanted(); }
  std::optional<Thumbnail> thumbnail(const std::string& agent) override { return link_.thumbnail(agent); }
  void send_status(const ServerStatus& status) override { link_.send_status(status); }
  void refuse(const Hello& hello, const std::string& reason) override { link_.refuse(hello, reason); }
  LinkBytes bytes(const std::string& agent) const override { return link_.bytes(agent); }
  ServerLinkCounts counts() const override { return link_.counts(); }
  const RejectionCounts& rejections() const override { return link_.rejections(); }

 private:
  ServerLink& link_;
  Recorder recorder_;
  std::optional<TimeNs> taken_ns_;  // time of the events that are being taken
};

}  // namespace coslam
