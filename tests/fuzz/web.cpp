// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What one client says to the web server: requests, and after an upgrade the frames of a WebSocket. The first octet
// says whether the server wants a token.
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "server/show/web/explain_answer.h"
#include "server/show/web/http_session.h"
#include "server/show/web/inside.h"
#include "tests/fuzz/fuzzer.h"
#include "tests/support/temp_folder.h"

namespace coslam {
namespace {

// A run that keeps no events but their head.
const ResultFolder& result() {
  static const test::TempFolder folder;
  static const ResultFolder of{folder.write("events.csv", "set,t_s,kind,why\n").parent_path()};
  return of;
}

void answer(const WebRequest& request, const WebReply& reply) {
  const auto question = question_of(request);
  reply(question ? explained(result(), *question) : no_question());
}

MessagePtr message_of(const ChannelPtr& channel) {
  return std::make_shared<const PublicMessage>(PublicMessage{channel, 7, {1, 2, 3}});
}

// All that there is to do now, and what follows from it.
void work_off(boost::asio::io_context& io) {
  io.restart();
  while (io.poll() > 0) {
  }
}

void serve(std::string_view said, bool with_token) {
  ViewConfig config;
  if (with_token) config.token = "secret";
  const auto inside = std::make_shared<WebInside>(config, "session", answer, WebLimits{});
  const auto channel = std::make_shared<const Channel>(Channel{.topic = "/coslam/map/points", .keep = 1});
  inside->hub.announce(channel);
  inside->hub.put(message_of(channel));
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) std::abort();
  using tcp = boost::asio::ip::tcp;
  std::make_shared<HttpSession>(*inside, tcp::socket(inside->io, tcp::v4(), ends[0]))->start();
  if (write(ends[1], said.data(), said.size()) != static_cast<ssize_t>(said.size())) std::abort();
  work_off(inside->io);
  inside->hub.put(message_of(channel));
  shutdown(ends[1], SHUT_WR);
  work_off(inside->io);
  inside->close();
  work_off(inside->io);
  close(ends[1]);
}

// A short frame of a client, with the mask 0.
std::string framed(char opcode, const std::string& payload) {
  return std::string(1, static_cast<char>(0x80 | opcode)) + static_cast<char>(0x80 | payload.size()) +
         std::string(4, '\0') + payload;
}

}  // namespace

void fuzz::try_octets(Octets octets) {
  if (!octets.empty()) serve(text_of(octets.subspan(1)), octets[0] % 2 != 0);
}

void fuzz::write_seeds(const WriteSeed& write) {
  const std::string open(1, '\0'), upgrade =
                                       " HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                                       "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n"
                                       "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n\r\n";
  write("explain", open +
                       "GET /api/v1/explain?kind=point&id=4%31&at=0.5 HTTP/1.1\r\nHost: localhost\r\n\r\n"
                       "HEAD / HTTP/1.1\r\n\r\n");
  write("token", "\1GET /metrics HTTP/1.1\r\nAuthorization: Bearer secret\r\nOrigin: http://localhost\r\n\r\n");
  write("subscribe", open + "GET /ws" + upgrade +
                         framed(1, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})") +
                         framed(1, R"({"op":"unsubscribe","subscriptionIds":[1]})") + framed(8, ""));
  write("subscribe_with_token", "\1GET /?token=secret" + upgrade + framed(9, "ping") + framed(1, R"({"op":"other"})"));
}

}  // namespace coslam
