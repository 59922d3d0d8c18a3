// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/string_body.hpp>
#include <memory>
#include <optional>

#include "server/show/web/inside.h"

namespace coslam {

// One connection, request after request, until it becomes a subscriber's.
class HttpSession final : public Connection, public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(WebInside& inside, boost::asio::ip::tcp::socket socket);

  void start() { read(); }
  void write(WebAnswer answer);
  void end() override;

 private:
  using Request = boost::beast::http::request<boost::beast::http::string_body>;
  using Response = boost::beast::http::response<boost::beast::http::span_body<const char>>;

  void read();
  void on_request(boost::beast::error_code error);
  void on_bad_request(boost::beast::error_code error);
  void handle(Request request);
  void upgrade(Request request, const WebRequest& target);
  bool may_read(const Request& request, const WebRequest& target) const;
  void refuse(int status, const std::string& why);
  void drain();

  boost::beast::tcp_stream stream_;
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;
  unsigned version_ = 11;
  bool head_ = false, keep_alive_ = false, ending_ = false;
  std::optional<Response> response_;
  std::shared_ptr<const void> owner_;  // keeps the body of the response
  std::array<char, 4096> rest_{};
  std::size_t drained_ = 0;
};

}  // namespace coslam
