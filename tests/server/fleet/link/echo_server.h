// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include "common/wire/addresses.h"
#include "server/fleet/link/dds_server_link.h"
#include "tests/support/eventually.h"

namespace coslam::test {

// A server that keeps all events and answers every frame with a patch.
class EchoServer {
 public:
  EchoServer(const WireConfig& config, RunId run, const AddressWatch::Addresses& addresses = local_addresses)
      : run_(run), link_(open_server_link(config, run, addresses)) {
    publish();
  }

  // Handles one event; false at the timeout.
  bool serve(std::chrono::milliseconds timeout) {
    auto event = link_->next_event(timeout);
    if (!event) return false;
    if (const auto* hello = std::get_if<Hello>(&*event)) {
      agents_.push_back(hello->agent);
      sequences_.try_emplace(hello->agent_run, 0);
      publish();
    }
    if (const auto* joined = std::get_if<JoinedFrame>(&*event)) answer(joined->frame);
    events_.push_back(std::move(*event));
    return true;
  }

  // Serves until `condition()` holds; false at the deadline.
  template <class Condition>
  bool serve_until(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + kDeadline;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      serve(std::chrono::milliseconds(20));
    }
    return true;
  }

  // Serves until there are `count` events of this type that match.
  template <class Event, class Match>
  bool serve_until_events(std::size_t count, Match match) {
    return serve_until([&] { return of_type<Event>(match).size() >= count; });
  }
  template <class Event>
  bool serve_until_events(std::size_t count) {
    return serve_until_events<Event>(count, [](const Event&) { return true; });
  }

  template <class Event, class Match>
  std::vector<Event> of_type(Match match) const {
    std::vector<Event> found;
    for (const ServerEvent& e : events_) {
      const auto* event = std::get_if<Event>(&e);
      if (event != nullptr && match(*event)) found.push_back(*event);
    }
    return found;
  }
  template <class Event>
  std::vector<Event> of_type() const {
    return of_type<Event>([](const Event&) { return true; });
  }

  const std::vector<ServerEvent>& events() const { return events_; }
  ServerLink& link() { return *link_; }

 private:
  void publish() {
    ServerStatus status;
    status.server_run = run_;
    status.started = true;
    status.agents = agents_;
    link_->send_status(status);
  }

  void answer(const TrackFrame& frame) {
    MapPatch patch;
    patch.agent = frame.agent;
    patch.agent_run = frame.agent_run;
    patch.server_run = run_;
    patch.sequence = ++sequences_[frame.agent_run];
    patch.after_frame = frame.frame;
    link_->send(patch);
  }

  const RunId run_;
  std::unique_ptr<ServerLink> link_;
  std::vector<ServerEvent> events_;
  std::vector<std::string> agents_;
  std::map<RunId, std::uint32_t> sequences_;
};

}  // namespace coslam::test
