// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Clients that are slow, stuck, hostile or too many.
#include <gmock/gmock.h>

#include <thread>

#include "server/show/web/web_server.h"
#include "tests/server/show/web/web_client.h"
#include "tests/support/eventually.h"

namespace coslam::web_abuse_test {
namespace {

using namespace std::chrono_literals;
using test::http_get;
using test::raw_exchange;
using test::WebClient;
using ::testing::HasSubstr;
using ::testing::StartsWith;

WebApi api() {
  return [](const WebRequest&, const WebReply& reply) { reply(plain_answer(200, "ok")); };
}

ViewConfig config(int most_clients = 100) {
  ViewConfig c;
  c.port = 0;
  c.most_clients = most_clients;
  return c;
}

ChannelPtr channel(const std::string& topic) {
  return std::make_shared<const Channel>(Channel{topic, Encoding::kCdr, "a/msg/Type", "int32 x\n", Part::kPoses, 0});
}

template <class Condition>
bool eventually(Condition condition) {
  const auto end = std::chrono::steady_clock::now() + test::kDeadline;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

TEST(WebAbuse, HeadersAndBodiesAreBounded) {
  WebServer server(config(), "run", api());
  const std::string long_header = "GET / HTTP/1.1\r\nHost: a\r\nX: " + std::string(1 << 20, 'x') + "\r\n\r\n";
  EXPECT_THAT(raw_exchange(server.port(), long_header), StartsWith("HTTP/1.1 431"));
  const std::string no_end(1 << 20, 'G');
  EXPECT_THAT(raw_exchange(server.port(), no_end), ::testing::AnyOf(StartsWith("HTTP/1.1 4"), ::testing::IsEmpty()));
  const std::string body = "POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 1000000\r\n\r\n" + std::string(1000000, 'x');
  EXPECT_THAT(raw_exchange(server.port(), body), StartsWith("HTTP/1.1 413"));
  EXPECT_EQ(http_get(server.port(), "/healthz").status, 200) << "the others notice nothing";
}

TEST(WebAbuse, NonsenseIsRefused) {
  WebServer server(config(), "run", api());
  for (const char* request :
       {"\r\n\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
        "GET / HTTP/1.1\r\nContent-Length: -1\r\n\r\n", "GET / HTTP/1.1\r\nno colon\r\n\r\n"}) {
    const std::string answer = raw_exchange(server.port(), request);
    EXPECT_THAT(answer, ::testing::AnyOf(StartsWith("HTTP/1.1 4"), ::testing::IsEmpty())) << request;
  }
  EXPECT_THAT(raw_exchange(server.port(), "DELETE / HTTP/1.1\r\nHost: a\r\n\r\n"), StartsWith("HTTP/1.1 405"));
  for (const char* path : {"/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/a/..%2f..%2fb", "//etc/passwd"})
    EXPECT_EQ(http_get(server.port(), path).status, 400) << path;
  EXPECT_EQ(http_get(server.port(), "/healthz").status, 200);
  EXPECT_GE(server.counts().refused, 5U);
}

TEST(WebAbuse, ASlowRequestIsGivenUp) {
  WebServer server(config(), "run", api(), {.request = 200ms});
  const auto before = std::chrono::steady_clock::now();
  EXPECT_EQ(raw_exchange(server.port(), "GET / HTTP/1.1\r\nHost: "), "");
  EXPECT_GE(std::chrono::steady_clock::now() - before, 150ms);
  EXPECT_TRUE(eventually([&] { return server.counts().open == 0; }));
}

TEST(WebAbuse, OnlySoManyConnectAtOnce) {
  WebServer server(config(2), "run", api());
  auto one = std::make_unique<WebClient>(server.port());
  const WebClient two(server.port());
  ASSERT_TRUE(one->open() && two.open());
  EXPECT_EQ(http_get(server.port(), "/healthz").status, 0);
  EXPECT_EQ(server.counts().turned_away, 1U);
  one.reset();
  EXPECT_TRUE(eventually([&] { return server.counts().open < 2; }));
  EXPECT_EQ(http_get(server.port(), "/healthz").status, 200);
}

TEST(WebAbuse, BrokenFramesEndTheirConnectionAlone) {
  WebServer server(config(), "run", api());
  WebClient good(server.port());
  const std::string masked_text("\x81\x85\x01\x02\x03\x04hello", 11);
  for (const std::string& frame : {std::string(14, '\xff'),          // bits that mean nothing
                                   std::string("\x81\x05hello", 7),  // not masked
                                   std::string("\x82\xff\x7f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14),  // 2^63 octets
                                   std::string("\x80\x80\0\0\0\0", 6),  // goes on with nothing
                                   masked_text}) {                      // text that is not UTF-8, no JSON
    WebClient client(server.port());
    ASSERT_TRUE(client.open());
    EXPECT_TRUE(client.send_raw(frame));
    EXPECT_TRUE(client.ended());
  }
  for (const std::string& text :
       {std::string("hello"), std::string(1 << 20, 'x'), std::string(R"({"op":"subscribe"})")}) {
    WebClient client(server.port());
    client.send_text(text);
    EXPECT_TRUE(client.ended()) << text.substr(0, 30);
  }
  EXPECT_TRUE(eventually([&] { return server.counts().subscribers == 1; }));
  EXPECT_TRUE(good.text("serverInfo"));
}

// It reads nothing, so that its window is full; the others get all.
TEST(WebAbuse, AStuckViewerHoldsUpNobody) {
  WebServer server(config(), "run", api(), {.stuck = 10min, .send_buffer_bytes = 16 << 10});
  const auto cloud = channel("/points"), tf = channel("/tf");
  server.announce(cloud);
  server.announce(tf);
  std::vector<std::unique_ptr<WebClient>> stuck;
  for (int i = 0; i < 5; ++i) {
    stuck.push_back(std::make_unique<WebClient>(server.port(), WebClient::Options{.receive_buffer_bytes = 4096}));
    ASSERT_TRUE(stuck.back()->subscribe("/points"));
  }
  WebClient good(server.port());
  ASSERT_TRUE(good.subscribe("/tf"));
  ASSERT_TRUE(
      eventually([&] { return server.wants(*cloud) && server.wants(*tf) && server.counts().subscribers == 6; }));
  for (int i = 1; i <= 100; ++i) {
    const auto before = std::chrono::steady_clock::now();
    server.put(std::make_shared<const PublicMessage>(PublicMessage{cloud, i, std::vector<std::uint8_t>(1 << 20)}));
    server.put(std::make_shared<const PublicMessage>(PublicMessage{tf, i, {1, 2, 3}}));
    EXPECT_LT(std::chrono::steady_clock::now() - before, 1s) << "whoever puts does not wait";
    const auto got = good.message();
    ASSERT_TRUE(got);
    EXPECT_EQ(got->t_ns, static_cast<std::uint64_t>(i));
  }
  EXPECT_TRUE(eventually([&] { return server.counts().dropped > 300; }));
  EXPECT_TRUE(good.open());
}

TEST(WebAbuse, AViewerThatStaysStuckIsCutOff) {
  WebServer server(config(), "run", api(), {.stuck = 400ms, .send_buffer_bytes = 16 << 10});
  const auto cloud = channel("/points"), tf = channel("/tf");
  server.announce(cloud);
  server.announce(tf);
  WebClient stuck(server.port(), {.receive_buffer_bytes = 4096}), good(server.port());
  ASSERT_TRUE(stuck.subscribe("/points"));
  ASSERT_TRUE(good.subscribe("/tf"));
  ASSERT_TRUE(eventually([&] { return server.wants(*cloud) && server.wants(*tf); }));
  server.put(std::make_shared<const PublicMessage>(PublicMessage{cloud, 1, std::vector<std::uint8_t>(8 << 20)}));
  EXPECT_TRUE(eventually([&] { return server.counts().cut_off == 1; }));
  EXPECT_TRUE(eventually([&] { return server.counts().subscribers == 1; }));
  EXPECT_TRUE(good.open());
}

TEST(WebAbuse, ASlowViewerLosesOldMessagesAndGetsNewOnes) {
  WebServer server(config(), "run", api(), {.send_buffer_bytes = 16 << 10});
  const auto cloud = channel("/points");
  server.announce(cloud);
  WebClient slow(server.port(), {.receive_buffer_bytes = 4096});
  ASSERT_TRUE(slow.subscribe("/points"));
  ASSERT_TRUE(eventually([&] { return server.wants(*cloud); }));
  for (int i = 1; i <= 50; ++i)
    server.put(std::make_shared<const PublicMessage>(PublicMessage{cloud, i, std::vector<std::uint8_t>(200'000)}));
  std::vector<std::uint64_t> got;
  do {
    const auto message = slow.message();
    ASSERT_TRUE(message);
    EXPECT_EQ(message->octets.size(), 200'000U);
    got.push_back(message->t_ns);
  } while (got.back() != 50);
  EXPECT_LT(got.size(), 10U);
  EXPECT_TRUE(std::ranges::is_sorted(got));
}

}  // namespace
}  // namespace coslam::web_abuse_test
