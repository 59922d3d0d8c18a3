// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/http_session.h"

#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <utility>

#include "server/show/web/foxglove.h"
#include "server/show/web/subscriber.h"

namespace coslam {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;

constexpr std::size_t kMostBody = 4096;  // nothing of ours takes one

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

// What tells how the run is, but nothing of the map.
bool is_open(std::string_view path) { return path == "/healthz" || path == "/readyz"; }
bool is_data(std::string_view path) { return path == "/metrics" || path.starts_with("/api/"); }

}  // namespace

HttpSession::HttpSession(WebInside& inside, boost::asio::ip::tcp::socket socket)
    : Connection(inside), stream_(std::move(socket)), buffer_(inside.limits.header_bytes + kMostBody) {}

void HttpSession::read() {
  parser_.emplace();
  parser_->header_limit(static_cast<std::uint32_t>(inside_.limits.header_bytes));
  parser_->body_limit(kMostBody);
  stream_.expires_after(inside_.limits.request);
  http::async_read(stream_, buffer_, *parser_,
                   [self = shared_from_this()](beast::error_code error, std::size_t) { self->on_request(error); });
}

void HttpSession::on_request(beast::error_code error) {
  if (ending_) return;
  if (error) return on_bad_request(error);
  handle(parser_->release());
}

void HttpSession::on_bad_request(beast::error_code error) {
  if (error == http::error::end_of_stream || error == http::error::partial_message) return;
  if (error == http::error::header_limit || error == http::error::buffer_overflow)
    return refuse(431, "the header of the request is too long");
  if (error == http::error::body_limit) return refuse(413, "the body of the request is too long");
  if (error == beast::error::timeout) {
    ++inside_.counts.refused;
    return;
  }
  if (error.category() == make_error_code(http::error::bad_method).category()) refuse(400, "this is no request");
}

void HttpSession::refuse(int status, const std::string& why) {
  ++inside_.counts.refused;
  keep_alive_ = false;
  write(plain_answer(status, why));
}

void HttpSession::handle(Request request) {
  version_ = request.version();
  head_ = request.method() == http::verb::head;
  keep_alive_ = request.keep_alive();
  if (request.method() != http::verb::get && !head_) return refuse(405, "there is only GET and HEAD here");
  const auto target = parse_target(view(request.target()));
  if (!target) return refuse(400, "this is no path");
  if (beast::websocket::is_upgrade(request)) return upgrade(std::move(request), *target);
  if (!is_open(target->path) && !is_data(target->path)) return write(page_answer(target->path));
  if (is_data(target->path) && !may_read(request, *target)) return refuse(401, "this needs the token of the server");
  const std::uint64_t id = inside_.next_request++;
  inside_.waiting.emplace(id, shared_from_this());
  inside_.api(*target, [id, weak = inside_.weak_from_this()](WebAnswer answer) {
    if (const auto inside = weak.lock()) inside->reply(id, std::move(answer));
  });
}

bool HttpSession::may_read(const Request& request, const WebRequest& target) const {
  const auto token = target.query.find("token");
  return inside_.access.granted({.host = view(request[http::field::host]),
                                 .origin = view(request[http::field::origin]),
                                 .authorization = view(request[http::field::authorization]),
                                 .token = token == target.query.end() ? std::string_view() : token->second});
}

void HttpSession::upgrade(Request request, const WebRequest& target) {
  if (target.path != "/ws" && target.path != "/") return refuse(404, "the WebSocket is at /ws");
  if (!may_read(request, target)) return refuse(401, "this needs the token of the server");
  const std::string protocol(foxglove::chosen_protocol(view(request[http::field::sec_websocket_protocol])));
  if (protocol.empty())
    return refuse(400, "the WebSocket speaks foxglove.sdk.v1 and foxglove.websocket.v1, and none was offered");
  stream_.expires_never();
  std::make_shared<Subscriber>(inside_, std::move(stream_))->start(std::move(request), protocol);
}

void HttpSession::write(WebAnswer answer) {
  if (ending_) return;
  response_.emplace(static_cast<http::status>(answer.status), version_);
  Response& r = *response_;
  r.set(http::field::server, "coslam");
  r.set(http::field::content_type, answer.type);
  r.set(http::field::cache_control, "no-cache");
  r.set(http::field::x_frame_options, "DENY");
  r.set("X-Content-Type-Options", "nosniff");
  r.set("Referrer-Policy", "no-referrer");
  r.set("Content-Security-Policy",
        "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; "
        "img-src 'self' data: blob:; worker-src 'self' blob:; connect-src 'self' ws: wss:; object-src 'none'; "
        "base-uri 'none'; frame-ancestors 'none'");
  if (!answer.encoding.empty()) r.set(http::field::content_encoding, answer.encoding);
  if (answer.status == 405) r.set(http::field::allow, "GET, HEAD");
  if (answer.status == 401) r.set(http::field::www_authenticate, "Bearer");
  r.keep_alive(keep_alive_);
  r.content_length(answer.body.size());
  if (!head_) r.body() = {answer.body.data(), answer.body.size()};
  owner_ = std::move(answer.owner);
  stream_.expires_after(inside_.limits.answer);
  http::async_write(stream_, r, [self = shared_from_this()](beast::error_code error, std::size_t) {
    self->owner_.reset();
    if (error || self->ending_) return;
    if (self->keep_alive_) return self->read();
    self->stream_.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, error);
    self->stream_.expires_after(self->inside_.limits.request);
    self->drain();
  });
}

// What is closed with something unread is reset, which can overtake the answer.
void HttpSession::drain() {
  constexpr std::size_t kMost = 4 << 20;
  stream_.async_read_some(boost::asio::buffer(rest_),
                          [self = shared_from_this()](beast::error_code error, std::size_t bytes) {
                            self->drained_ += bytes;
                            if (!error && !self->ending_ && self->drained_ < kMost) self->drain();
                          });
}

void HttpSession::end() {
  ending_ = true;
  stream_.close();
}

}  // namespace coslam
