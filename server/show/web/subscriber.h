// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <memory>
#include <optional>
#include <string>

#include "server/show/web/inside.h"
#include "server/show/web/outbox.h"

namespace coslam {

// A connection that speaks the Foxglove WebSocket protocol. It is cut off when it does not take what it is sent.
class Subscriber final : public Connection, public HubClient, public std::enable_shared_from_this<Subscriber> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::string_body>;

  Subscriber(WebInside& inside, boost::beast::tcp_stream stream);
  ~Subscriber() override;
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;

  void start(Request request, const std::string& protocol);

  void send_text(std::string text) override;
  void send_message(foxglove::SubscriptionId subscription, const MessagePtr& message) override;
  void send_time(TimeNs t_ns) override;

  void check(Clock::time_point now) override;
  void end() override;

 private:
  enum class State : std::uint8_t { kOpen, kLeaving, kClosed };

  void on_accept(boost::beast::error_code error);
  void read();
  void on_text(boost::beast::error_code error);
  void pump();
  void on_sent(boost::beast::error_code error);
  // Closes the connection with a word to the client, once what is being sent is out.
  void leave(boost::beast::websocket::close_code code, const std::string& why);
  void close_now();
  // Closes the connection without a word.
  void cut_off();
  void note_closed();

  boost::beast::websocket::stream<boost::beast::tcp_stream> stream_;
  Request request_;
  boost::beast::flat_buffer buffer_;
  Outbox outbox_;
  std::uint64_t counted_dropped_ = 0;
  std::optional<Outbox::Item> going_;
  Clock::time_point going_since_;
  State state_ = State::kOpen;
  bool joined_ = false;
  boost::beast::websocket::close_reason reason_;
};

}  // namespace coslam
