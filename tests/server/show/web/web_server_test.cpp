// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/web_server.h"

#include <gmock/gmock.h>

#include <thread>

#include "common/base/error.h"
#include "tests/server/show/web/web_client.h"
#include "tests/support/eventually.h"
#include "tests/support/temp_folder.h"

namespace coslam::web_server_test {
namespace {

using test::http_get;
using test::WebClient;
using ::testing::HasSubstr;

ViewConfig config() {
  ViewConfig c;
  c.port = 0;
  return c;
}

ChannelPtr channel(const std::string& topic, std::size_t keep = 0) {
  return std::make_shared<const Channel>(Channel{topic, Encoding::kCdr, "a/msg/Type", "int32 x\n", Part::kPoses, keep});
}

MessagePtr message(const ChannelPtr& of, TimeNs t_ns, std::size_t bytes = 8) {
  return std::make_shared<const PublicMessage>(
      PublicMessage{of, t_ns, std::vector<std::uint8_t>(bytes, static_cast<std::uint8_t>(t_ns))});
}

WebApi echo() {
  return [](const WebRequest& request, const WebReply& reply) { reply(plain_answer(200, "asked " + request.path)); };
}

class WebServerTest : public ::testing::Test {
 protected:
  WebServerTest() { server_.announce(tf_); }
  // Somebody's subscription has come to the server.
  bool wanted(const ChannelPtr& channel) const {
    const auto end = std::chrono::steady_clock::now() + test::kDeadline;
    while (!server_.wants(*channel)) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::yield();
    }
    return true;
  }

  const ChannelPtr tf_ = channel("/tf");
  WebServer server_{config(), "run", echo()};
};

TEST_F(WebServerTest, ShowsThePageAndAnswersRequests) {
  const auto page = http_get(server_.port(), "/");
  EXPECT_EQ(page.status, 200);
  EXPECT_THAT(page.type, HasSubstr("text/html"));
  // With the page it is packed.
  EXPECT_THAT(page.body, ::testing::AnyOf(HasSubstr("<html"), ::testing::StartsWith("\x1f\x8b")));
  EXPECT_EQ(http_get(server_.port(), "/api/v1/agents").body, "asked /api/v1/agents\n");
  EXPECT_EQ(http_get(server_.port(), "/nothing").status, 404);
  EXPECT_EQ(server_.url(), "http://127.0.0.1:" + std::to_string(server_.port()) + "/");
}

TEST_F(WebServerTest, SubscribersGetMessages) {
  for (const char* protocol : {"foxglove.sdk.v1", "foxglove.websocket.v1"}) {
    WebClient client(server_.port(), {.protocol = protocol});
    ASSERT_TRUE(client.open());
    EXPECT_EQ(client.protocol(), protocol);
    EXPECT_EQ((*client.text("serverInfo"))["sessionId"], "run");
    ASSERT_TRUE(client.subscribe("/tf"));
    EXPECT_EQ(client.channels().at("/tf")["schema"], "int32 x\n");
    ASSERT_TRUE(wanted(tf_));
    server_.put(message(tf_, 5));
    const auto got = client.message();
    ASSERT_TRUE(got);
    EXPECT_EQ(got->topic, "/tf");
    EXPECT_EQ(got->t_ns, 5U);
    EXPECT_EQ(got->octets, std::string(8, '\5'));
    client.unsubscribe("/tf");
    const auto end = std::chrono::steady_clock::now() + test::kDeadline;
    while (server_.wants(*tf_) && std::chrono::steady_clock::now() < end) std::this_thread::yield();
    EXPECT_FALSE(server_.wants(*tf_));
  }
}

TEST_F(WebServerTest, SpeaksAtTheTopToo) {
  EXPECT_TRUE(WebClient(server_.port(), {.target = "/"}).open()) << "where Foxglove looks first";
  EXPECT_EQ(WebClient(server_.port(), {.target = "/elsewhere"}).refusal(), 404);
  EXPECT_EQ(WebClient(server_.port(), {.protocol = ""}).refusal(), 400);
  EXPECT_EQ(WebClient(server_.port(), {.protocol = "chat"}).refusal(), 400);
}

TEST_F(WebServerTest, ThoseWhoComeLaterGetWhatIsKept) {
  const auto state = channel("/state", 1);
  server_.announce(state);
  server_.put(message(state, 1));
  server_.put(message(state, 2));
  WebClient client(server_.port());
  ASSERT_TRUE(client.subscribe("/state"));
  EXPECT_EQ(client.message()->t_ns, 2U);
}

TEST_F(WebServerTest, WhatIsLeftIsSentAtTheEnd) {
  auto server = std::make_unique<WebServer>(config(), "run", echo());
  server->announce(tf_);
  WebClient client(server->port());
  ASSERT_TRUE(client.subscribe("/tf"));
  const auto end = std::chrono::steady_clock::now() + test::kDeadline;
  while (!server->wants(*tf_) && std::chrono::steady_clock::now() < end) std::this_thread::yield();
  server->put(message(tf_, 9, 1 << 20));
  std::thread ending([&] { server.reset(); });
  const auto last = client.message();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->octets.size(), 1U << 20U);
  EXPECT_TRUE(client.ended());
  ending.join();
}

TEST(WebServer, ATokenIsNeededWhereOthersCanReachIt) {
  ViewConfig open = config();
  open.address = "0.0.0.0";
  const WebServer server(open, "run", echo());
  const std::size_t mark = server.url().find("?token=");
  ASSERT_NE(mark, std::string::npos) << "one is drawn and said";
  const std::string token = server.url().substr(mark + 7);
  EXPECT_EQ(http_get(server.port(), "/").status, 200) << "the page tells nothing";
  EXPECT_EQ(http_get(server.port(), "/healthz").status, 200);
  EXPECT_EQ(http_get(server.port(), "/metrics").status, 401);
  EXPECT_EQ(http_get(server.port(), "/api/v1/agents?token=wrong").status, 401);
  EXPECT_EQ(http_get(server.port(), "/api/v1/agents?token=" + token).status, 200);
  EXPECT_EQ(http_get(server.port(), "/metrics", {{"Authorization", "Bearer " + token}}).status, 200);
  EXPECT_EQ(WebClient(server.port()).refusal(), 401);
  EXPECT_TRUE(WebClient(server.port(), {.target = "/ws?token=" + token}).open());
}

TEST(WebServer, WithoutATokenPagesFromElsewhereGetNothing) {
  const WebServer server(config(), "run", echo());
  EXPECT_EQ(WebClient(server.port(), {.headers = {{"Origin", "https://elsewhere.org"}}}).refusal(), 401);
  EXPECT_TRUE(WebClient(server.port(), {.headers = {{"Origin", "http://localhost:3000"}}}).open());
  EXPECT_EQ(http_get(server.port(), "/metrics", {{"Host", "elsewhere.org"}}).status, 401);
}

TEST(WebServer, SaysWhyItCannotListen) {
  const WebServer server(config(), "run", echo());
  ViewConfig taken = config();
  taken.port = server.port();
  const std::string why = test::error_of<UserError>([&] { WebServer(taken, "run", echo()); });
  EXPECT_THAT(why, HasSubstr(std::to_string(taken.port)));
  ViewConfig nowhere = config();
  nowhere.address = "somewhere";
  EXPECT_THAT(test::error_of<UserError>([&] { WebServer(nowhere, "run", echo()); }), HasSubstr("no IP address"));
}

TEST(WebServer, AnswersMayComeFromElsewhereAndTooLate) {
  WebReply late;
  std::thread other;
  auto server = std::make_unique<WebServer>(config(), "run", [&](const WebRequest& request, const WebReply& reply) {
    if (request.path == "/metrics") {
      other = std::thread([reply] { reply(plain_answer(200, "from another thread")); });
    } else {
      late = reply;
    }
  });
  const std::uint16_t port = server->port();
  EXPECT_EQ(http_get(port, "/metrics").body, "from another thread\n");
  other.join();
  std::thread waiting([&] { EXPECT_EQ(http_get(port, "/api/v1/late").status, 0); });
  const auto end = std::chrono::steady_clock::now() + test::kDeadline;
  while (server->counts().connections < 2 && std::chrono::steady_clock::now() < end) std::this_thread::yield();
  server.reset();
  waiting.join();
  if (late) late(plain_answer(200, "nobody is there any more"));
}

}  // namespace
}  // namespace coslam::web_server_test
