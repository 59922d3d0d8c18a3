// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/server/show/web/web_client.h"

#include <algorithm>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <cstring>

#include "tests/support/eventually.h"

namespace coslam::test {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = net::ip::tcp;

tcp::endpoint server(std::uint16_t port) { return {net::ip::make_address("127.0.0.1"), port}; }

// Begins one operation and waits until it is over.
template <class Begin>
beast::error_code wait(net::io_context& io, Begin begin) {
  beast::error_code result = net::error::would_block;
  begin([&](beast::error_code error, auto&&...) { result = error; });
  io.restart();
  io.run_for(kDeadline);
  return result;
}

}  // namespace

HttpResponse http_get(std::uint16_t port, const std::string& target, const Headers& headers) {
  net::io_context io;
  beast::tcp_stream stream(io);
  HttpResponse out;
  if (wait(io, [&](auto done) { stream.async_connect(server(port), done); })) return out;
  http::request<http::empty_body> request(http::verb::get, target, 11);
  request.set(http::field::host, "127.0.0.1");
  for (const auto& [name, value] : headers) request.set(name, value);
  if (wait(io, [&](auto done) { http::async_write(stream, request, done); })) return out;
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.body_limit(64 << 20);
  if (wait(io, [&](auto done) { http::async_read(stream, buffer, parser, done); })) return out;
  out.status = static_cast<int>(parser.get().result_int());
  out.type = std::string(parser.get()[http::field::content_type]);
  out.body = parser.get().body();
  return out;
}

std::string raw_exchange(std::uint16_t port, const std::string& octets) {
  net::io_context io;
  tcp::socket socket(io);
  std::string answer;
  if (wait(io, [&](auto done) { socket.async_connect(server(port), done); })) return answer;
  // It may be refused before all of it is sent.
  wait(io, [&](auto done) { net::async_write(socket, net::buffer(octets), done); });
  std::array<char, 4096> part{};
  std::size_t bytes = 0;
  while (!wait(io, [&](auto done) {
    socket.async_read_some(net::buffer(part), [&, done](beast::error_code error, std::size_t n) {
      bytes = n;
      done(error);
    });
  })) {
    answer.append(part.data(), bytes);
  }
  return answer;
}

WebClient::WebClient(std::uint16_t port, const Options& options) {
  auto& tcp_stream = beast::get_lowest_layer(stream_);
  auto& socket = tcp_stream.socket();
  socket.open(tcp::v4());
  if (options.receive_buffer_bytes > 0)
    socket.set_option(net::socket_base::receive_buffer_size(options.receive_buffer_bytes));
  if (wait(io_, [&](auto done) { tcp_stream.async_connect(server(port), done); })) return;
  stream_.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
    if (!options.protocol.empty()) request.set(http::field::sec_websocket_protocol, options.protocol);
    for (const auto& [name, value] : options.headers) request.set(name, value);
  }));
  websocket::response_type response;
  const auto error =
      wait(io_, [&](auto done) { stream_.async_handshake(response, "127.0.0.1", options.target, done); });
  open_ = !error;
  refusal_ = error == websocket::error::upgrade_declined ? static_cast<int>(response.result_int()) : 0;
  protocol_ = std::string(response[http::field::sec_websocket_protocol]);
}

bool WebClient::read() {
  if (!open_) return false;
  beast::flat_buffer buffer;
  if (wait(io_, [&](auto done) { stream_.async_read(buffer, done); })) {
    open_ = false;
    return false;
  }
  const std::string octets = beast::buffers_to_string(buffer.data());
  if (stream_.got_text()) {
    const auto json = nlohmann::json::parse(octets);
    if (json["op"] == "advertise") {
      for (const auto& c : json["channels"]) {
        channels_[c["topic"]] = c;
        topics_[c["id"]] = c["topic"];
      }
    }
    texts_.push_back(json);
    return true;
  }
  std::uint32_t subscription = 0;
  std::uint64_t t_ns = 0;
  if (octets.size() == 9 && octets[0] == 2) {
    std::memcpy(&newest_time_, &octets[1], 8);
  } else if (octets.size() >= 13 && octets[0] == 1) {
    std::memcpy(&subscription, &octets[1], 4);
    std::memcpy(&t_ns, &octets[5], 8);
    messages_.push_back({topics_[subscription], t_ns, octets.substr(13)});
  }
  return true;
}

std::optional<std::uint32_t> WebClient::channel(const std::string& topic) {
  while (!channels_.contains(topic)) {
    if (!read()) return std::nullopt;
  }
  return channels_[topic]["id"].get<std::uint32_t>();
}

bool WebClient::subscribe(const std::string& topic) {
  const auto id = channel(topic);
  if (!id) return false;
  return send_text(nlohmann::json{{"op", "subscribe"}, {"subscriptions", {{{"id", *id}, {"channelId", *id}}}}}.dump());
}

bool WebClient::unsubscribe(const std::string& topic) {
  const auto id = channel(topic);
  return id && send_text(nlohmann::json{{"op", "unsubscribe"}, {"subscriptionIds", {*id}}}.dump());
}

std::optional<WebClient::Message> WebClient::message() {
  while (messages_.empty()) {
    if (!read()) return std::nullopt;
  }
  Message out = std::move(messages_.front());
  messages_.erase(messages_.begin());
  return out;
}

std::optional<WebClient::Message> WebClient::message_where(const std::string& topic,
                                                           const std::function<bool(const Message&)>& pleases) {
  while (auto m = message()) {
    if (m->topic == topic && pleases(*m)) return m;
  }
  return std::nullopt;
}

std::optional<nlohmann::json> WebClient::text(const std::string& op) {
  while (true) {
    const auto at = std::ranges::find_if(texts_, [&](const auto& t) { return t["op"] == op; });
    if (at != texts_.end()) {
      nlohmann::json out = *at;
      texts_.erase(at);
      return out;
    }
    if (!read()) return std::nullopt;
  }
}

bool WebClient::send_text(const std::string& text) {
  if (!open_) return false;
  stream_.text(true);
  return !wait(io_, [&](auto done) { stream_.async_write(net::buffer(text), done); });
}

bool WebClient::send_raw(const std::string& octets) {
  auto& socket = beast::get_lowest_layer(stream_).socket();
  return !wait(io_, [&](auto done) { net::async_write(socket, net::buffer(octets), done); });
}

bool WebClient::ended() {
  while (read()) {
  }
  return !open_;
}

}  // namespace coslam::test
