// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/inside.h"

#include <boost/asio/post.hpp>
#include <cerrno>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "common/flow/give_way.h"
#include "server/show/web/http_session.h"

namespace coslam {
namespace {

namespace net = boost::asio;
using tcp = net::ip::tcp;

}  // namespace

Connection::Connection(WebInside& inside) : inside_(inside) {
  inside_.connections.insert(this);
  inside_.counts.open = inside_.connections.size();
}

Connection::~Connection() {
  inside_.connections.erase(this);
  inside_.counts.open = inside_.connections.size();
  inside_.end_if_done();
}

WebInside::WebInside(const ViewConfig& view, const std::string& session, WebApi answers, const WebLimits& bounds)
    : config(view), limits(bounds), api(std::move(answers)), access(view.token, view.origins), hub(session) {}

void WebInside::listen() {
  boost::system::error_code error;
  const auto address = net::ip::make_address(config.address, error);
  if (error) throw UserError("server.view.address: '" + config.address + "' is no IP address");
  const tcp::endpoint end(address, static_cast<std::uint16_t>(config.port));
  acceptor.open(end.protocol(), error);
  if (!error) acceptor.set_option(net::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(end, error);
  if (!error) acceptor.listen(net::socket_base::max_listen_connections, error);
  if (!error) port = acceptor.local_endpoint(error).port();
  if (error) {
    throw UserError("the web server cannot listen on port " + std::to_string(config.port) + " of " + config.address +
                    ": " + error.message() +
                    (error.value() == EADDRNOTAVAIL ? ": server.view.address takes an address of this machine"
                                                    : "; 0 takes a free one"));
  }
}

void WebInside::run() {
  give_way();
  accept();
  check_later();
  io.run();
  ended = true;
}

void WebInside::accept() {
  acceptor.async_accept([this](boost::system::error_code error, tcp::socket socket) {
    if (closing) return;
    if (!error) {
      take_in(std::move(socket));
      return accept();
    }
    // No file descriptors, perhaps: not again at once.
    accept_timer.expires_after(std::chrono::milliseconds(100));
    accept_timer.async_wait([this](boost::system::error_code stopped) {
      if (!stopped) accept();
    });
  });
}

void WebInside::take_in(tcp::socket socket) {
  ++counts.connections;
  if (connections.size() >= static_cast<std::size_t>(config.most_clients)) {
    ++counts.turned_away;
    return;
  }
  boost::system::error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  socket.set_option(net::socket_base::send_buffer_size(limits.send_buffer_bytes), ignored);
  std::make_shared<HttpSession>(*this, std::move(socket))->start();
}

void WebInside::check_later() {
  check_timer.expires_after(limits.stuck / 4);
  check_timer.async_wait([this](boost::system::error_code stopped) {
    if (stopped) return;
    // Those that are cut off go later: their handlers hold them.
    for (Connection* c : connections) c->check(Connection::Clock::now());
    check_later();
  });
}

void WebInside::close() {
  closing = true;
  boost::system::error_code ignored;
  acceptor.close(ignored);
  check_timer.cancel();
  accept_timer.cancel();
  waiting.clear();
  for (Connection* c : std::vector<Connection*>(connections.begin(), connections.end())) c->end();
  farewell_timer.expires_after(limits.farewell);
  farewell_timer.async_wait([this](boost::system::error_code) { io.stop(); });
  end_if_done();
}

void WebInside::end_if_done() {
  if (closing && !ended && connections.empty()) io.stop();
}

void WebInside::reply(std::uint64_t request, WebAnswer answer) {
  net::post(io, [this, request, answer = std::move(answer)]() mutable {
    const auto session = waiting.extract(request);
    if (session) session.mapped()->write(std::move(answer));
  });
}

void WebInside::update_wanted() {
  Hub::Wanted now = hub.wanted();
  {
    const std::lock_guard lock(wanted_mutex);
    wanted = std::move(now.topics);
  }
  parts = now.parts.bits;
}

}  // namespace coslam
