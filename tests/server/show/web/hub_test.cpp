// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/hub.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace coslam::hub_test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::SizeIs;

struct Client : HubClient {
  void send_text(std::string text) override { texts.push_back(json::parse(text)); }
  void send_message(foxglove::SubscriptionId id, const MessagePtr& message) override {
    messages.emplace_back(id, message->t_ns);
  }
  void send_time(TimeNs t_ns) override { times.push_back(t_ns); }

  std::vector<json> texts;
  std::vector<std::pair<foxglove::SubscriptionId, TimeNs>> messages;
  std::vector<TimeNs> times;
};

ChannelPtr channel(const std::string& topic, Part part, std::size_t keep = 0) {
  return std::make_shared<const Channel>(Channel{topic, Encoding::kJson, "type", "{}", part, keep});
}

class HubTest : public ::testing::Test {
 protected:
  HubTest() {
    hub_.announce(tf_);
    hub_.announce(state_);
  }
  void put(const ChannelPtr& on, TimeNs t_ns) {
    hub_.put(std::make_shared<const PublicMessage>(PublicMessage{on, t_ns, {1}}));
  }
  bool subscribe(Client& client, int id, int to) {
    const json text{{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", to}}}}};
    return hub_.hear(client, text.dump());
  }

  const ChannelPtr tf_ = channel("/tf", Part::kPoses), state_ = channel("/state", Part::kState, 2);
  Hub hub_{"session"};
};

TEST_F(HubTest, AClientIsToldOfAllChannelsAndOfNewOnes) {
  Client client;
  hub_.join(client);
  ASSERT_THAT(client.texts, SizeIs(2));
  EXPECT_EQ(client.texts[0]["op"], "serverInfo");
  EXPECT_THAT(client.texts[1]["channels"], SizeIs(2));
  hub_.announce(channel("/late", Part::kPaths));
  EXPECT_EQ(client.texts[2]["channels"][0]["id"], 3);
  hub_.announce(channel("/late", Part::kPaths));
  EXPECT_THAT(client.texts, SizeIs(3)) << "once";
}

TEST_F(HubTest, MessagesGoToWhoeverSubscribed) {
  Client one, other;
  hub_.join(one);
  hub_.join(other);
  EXPECT_TRUE(subscribe(one, 40, 1));
  put(tf_, 5);
  EXPECT_THAT(one.messages, ElementsAre(Pair(40U, 5)));
  EXPECT_THAT(one.times, ElementsAre(5));
  EXPECT_THAT(other.messages, IsEmpty());
  EXPECT_TRUE(hub_.hear(one, R"({"op":"unsubscribe","subscriptionIds":[40, 99]})"));
  put(tf_, 6);
  EXPECT_THAT(one.messages, SizeIs(1));
}

TEST_F(HubTest, WhoComesLaterGetsWhatIsKept) {
  for (const TimeNs t : {1, 2, 3}) put(state_, t);
  put(tf_, 3);
  Client client;
  hub_.join(client);
  subscribe(client, 7, 2);
  EXPECT_THAT(client.messages, ElementsAre(Pair(7U, 2), Pair(7U, 3)));
  subscribe(client, 8, 1);
  EXPECT_THAT(client.messages, SizeIs(2)) << "of the other nothing is kept";
}

TEST_F(HubTest, KnowsWhatIsWanted) {
  Client one, other;
  hub_.join(one);
  hub_.join(other);
  EXPECT_THAT(hub_.wanted().topics, IsEmpty());
  subscribe(one, 1, 1);
  subscribe(other, 1, 1);
  subscribe(other, 2, 2);
  EXPECT_THAT(hub_.wanted().topics, ElementsAre("/state", "/tf"));
  EXPECT_TRUE(hub_.wanted().parts.has(Part::kState));
  EXPECT_FALSE(hub_.wanted().parts.has(Part::kCloud));
  hub_.leave(other);
  EXPECT_THAT(hub_.wanted().topics, ElementsAre("/tf"));
  hub_.leave(one);
  EXPECT_THAT(hub_.wanted().topics, IsEmpty());
}

TEST_F(HubTest, AnswersWhatItCannotDo) {
  Client client;
  hub_.join(client);
  const auto told = [&]() -> std::string {
    const json last = client.texts.back();
    return last["op"] == "status" ? last["message"].get<std::string>() : "";
  };
  EXPECT_TRUE(subscribe(client, 1, 99));
  EXPECT_THAT(told(), HasSubstr("no channel 99"));
  subscribe(client, 1, 1);
  EXPECT_TRUE(subscribe(client, 1, 2));
  EXPECT_THAT(told(), HasSubstr("there already"));
  EXPECT_TRUE(subscribe(client, 2, 1));
  EXPECT_THAT(told(), HasSubstr("another one"));
  EXPECT_TRUE(hub_.hear(client, R"({"op":"setParameters","parameters":[]})"));
  EXPECT_THAT(told(), HasSubstr("only be read"));
  EXPECT_FALSE(hub_.hear(client, "hello"));
}

}  // namespace
}  // namespace coslam::hub_test
