// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "common/flow/worker.h"
#include "server/show/web/access.h"
#include "server/show/web/hub.h"
#include "server/show/web/web_server.h"

namespace coslam {

// An open connection. Of the web thread.
class Connection {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Connection(WebInside& inside);
  virtual ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  // Looks whether it is stuck.
  virtual void check(Clock::time_point) {}
  // The server ends.
  virtual void end() = 0;

 protected:
  WebInside& inside_;
};

class HttpSession;

// State of the web thread.
struct WebInside : std::enable_shared_from_this<WebInside> {
  WebInside(const ViewConfig& view, const std::string& session, WebApi answers, const WebLimits& bounds);

  void listen();
  void run();
  void close();

  void end_if_done();

  // Answers a request that waits; callable from any thread.
  void reply(std::uint64_t request, WebAnswer answer);
  void update_wanted();

  const ViewConfig config;
  const WebLimits limits;
  const WebApi api;
  const Access access;
  Hub hub;

  struct Counts {
    std::atomic<std::uint64_t> connections{0}, turned_away{0}, refused{0}, cut_off{0}, sent{0}, dropped{0};
    std::atomic<std::size_t> open{0}, subscribers{0};
  } counts;
  std::atomic<std::size_t> on_the_way{0};  // messages that were put but not taken by the web thread yet

  mutable std::mutex wanted_mutex;
  std::set<std::string> wanted;
  std::atomic<std::uint32_t> parts{0};  // parts that the wanted topics are made of

  std::uint16_t port = 0;  // port that it listens on
  bool closing = false, ended = false;
  std::set<Connection*> connections;
  std::uint64_t next_request = 1;
  std::map<std::uint64_t, std::shared_ptr<HttpSession>> waiting;

  // Handlers that wait in it hold connections, which name what is above.
  boost::asio::io_context io{1};
  boost::asio::ip::tcp::acceptor acceptor{io};
  boost::asio::steady_timer check_timer{io}, accept_timer{io}, farewell_timer{io};
  std::optional<Worker> worker;

 private:
  void accept();
  void take_in(boost::asio::ip::tcp::socket socket);
  void check_later();
};

}  // namespace coslam
