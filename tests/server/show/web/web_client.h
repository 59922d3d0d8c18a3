// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace coslam::test {

using Headers = std::map<std::string, std::string>;

struct HttpResponse {
  int status = 0;  // 0: the connection ended without one
  std::string type, body;
};

// One request on a connection of its own; everything within the deadline of a test.
HttpResponse http_get(std::uint16_t port, const std::string& target, const Headers& headers = {});
// These octets as they are, and what comes back until the server ends the connection.
std::string raw_exchange(std::uint16_t port, const std::string& octets);

// A viewer that speaks the Foxglove WebSocket protocol.
class WebClient {
 public:
  struct Options {
    std::string target = "/ws";
    std::string protocol = "foxglove.websocket.v1";  // empty: none is offered
    Headers headers = {};
    int receive_buffer_bytes = 0;  // 0: that of the system
  };
  explicit WebClient(std::uint16_t port, const Options& options);
  explicit WebClient(std::uint16_t port) : WebClient(port, Options()) {}

  bool open() const { return open_; }
  int refusal() const { return refusal_; }  // HTTP status of the answer that turned it away
  const std::string& protocol() const { return protocol_; }

  struct Message {
    std::string topic;
    std::uint64_t t_ns = 0;
    std::string octets;
  };
  // The id of a topic, waiting until it is advertised.
  std::optional<std::uint32_t> channel(const std::string& topic);
  bool subscribe(const std::string& topic);  // by the id of its channel
  bool unsubscribe(const std::string& topic);
  // The next message that was subscribed to. Empty when the connection ended or none came in time.
  std::optional<Message> message();
  // The next one of a topic that pleases.
  std::optional<Message> message_where(const std::string& topic, const std::function<bool(const Message&)>& pleases);
  // The next text of this kind.
  std::optional<nlohmann::json> text(const std::string& op);

  bool send_text(const std::string& text);
  bool send_raw(const std::string& octets);  // below the WebSocket
  bool ended();                              // waits for the end of the connection
  const std::map<std::string, nlohmann::json>& channels() const { return channels_; }

 private:
  bool read();  // one frame, kept
  boost::beast::error_code run();

  boost::asio::io_context io_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> stream_{io_};
  bool open_ = false;
  int refusal_ = 0;
  std::string protocol_;
  std::map<std::string, nlohmann::json> channels_;
  std::map<std::uint32_t, std::string> topics_;
  std::vector<Message> messages_;
  std::vector<nlohmann::json> texts_;
  std::uint64_t newest_time_ = 0;
};

}  // namespace coslam::test
