// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "server/show/publish/channel.h"
#include "server/show/web/answer.h"
#include "server/show/web/view_config.h"

namespace coslam {

struct WebInside;

struct WebLimits {
  std::chrono::milliseconds request{5'000};   // for a request to come, and between two of a connection
  std::chrono::milliseconds answer{120'000};  // for an answer to go
  std::chrono::milliseconds stuck{10'000};    // for one message to a subscriber to go; then it is cut off
  std::chrono::milliseconds idle{30'000};     // for a sign of life of a subscriber, which is asked for one
  std::chrono::milliseconds farewell{1'000};  // for all to take what is left for them at the end
  std::size_t header_bytes = 16 << 10;
  std::size_t text_bytes = 64 << 10;  // maximum size of a subscriber's message
  int send_buffer_bytes = 512 << 10;  // buffer of one connection
};

struct WebCounts {
  std::uint64_t connections = 0;  // ever
  std::uint64_t turned_away = 0;  // connections refused because there were too many
  std::uint64_t refused = 0;      // requests and texts that were no good
  std::uint64_t cut_off = 0;      // subscribers that were stuck
  std::uint64_t sent = 0;         // messages
  std::uint64_t dropped = 0;      // messages that a slow subscriber did not get
  std::size_t open = 0;           // connections
  std::size_t subscribers = 0;    // connections that subscribed to messages
};

// Shows the page, answers requests, and sends messages to whoever subscribes, over the Foxglove WebSocket protocol: all
// on one port, in a thread of its own. No client, however slow or hostile, holds up anybody. Thread-safe.
class WebServer final : public PublicSink {
 public:
  // session: names the run to clients. api: answers what is no file of the page. Throws UserError when it cannot
  // listen.
  WebServer(const ViewConfig& config, const std::string& session, WebApi api, const WebLimits& limits = {});
  ~WebServer() override;  // sends what is left, within WebLimits::farewell
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  std::uint16_t port() const;
  // Address of the page for a browser, with the token.
  std::string url() const;
  // Address of the page with one of the addresses of this machine.
  std::string url(const std::string& address) const;
  WebCounts counts() const;

  void announce(const ChannelPtr& channel) override;
  bool wants(const Channel& channel) const override;
  PartSet parts() const override;
  void put(const MessagePtr& message) override;

 private:
  std::shared_ptr<WebInside> inside_;
};

}  // namespace coslam
