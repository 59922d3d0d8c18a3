// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/foxglove.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace coslam::foxglove_test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::Pair;

TEST(Foxglove, SpeaksTwoSubProtocols) {
  EXPECT_EQ(foxglove::chosen_protocol("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(foxglove::chosen_protocol("foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(foxglove::chosen_protocol("other, foxglove.websocket.v1,foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(foxglove::chosen_protocol("foxglove.websocket.v10, chat"), "");
  EXPECT_EQ(foxglove::chosen_protocol(""), "");
}

TEST(Foxglove, Advertises) {
  const Channel cdr{"/tf", Encoding::kCdr, "tf2_msgs/msg/TFMessage", "the definition", Part::kPoses};
  const Channel text{"/coslam/state", Encoding::kJson, "coslam.State", "{}", Part::kState};
  const json said = json::parse(foxglove::advertise({{1, &cdr}, {2, &text}}));
  EXPECT_EQ(said["op"], "advertise");
  EXPECT_EQ(said["channels"][0],
            json::parse(R"({"id":1,"topic":"/tf","encoding":"cdr","schemaName":"tf2_msgs/msg/TFMessage",
                            "schema":"the definition","schemaEncoding":"ros2msg"})"));
  EXPECT_EQ(said["channels"][1]["encoding"], "json");
  EXPECT_EQ(said["channels"][1]["schemaEncoding"], "jsonschema");
  const json info = json::parse(foxglove::server_info("run"));
  EXPECT_EQ(info["op"], "serverInfo");
  EXPECT_EQ(info["capabilities"], json::parse(R"(["time"])"));
  EXPECT_EQ(info["sessionId"], "run");
}

TEST(Foxglove, BinaryMessagesAreLittleEndian) {
  EXPECT_EQ(foxglove::message_head(0x01020304, 0x0a0b), std::string("\x01\x04\x03\x02\x01\x0b\x0a\0\0\0\0\0\0", 13));
  EXPECT_EQ(foxglove::time_message(1), std::string("\x02\x01\0\0\0\0\0\0\0", 9));
  EXPECT_EQ(foxglove::time_message(-1), std::string("\x02\0\0\0\0\0\0\0\0", 9)) << "stamps have no sign";
}

TEST(Foxglove, ReadsWhatClientsSay) {
  const auto subscribe =
      foxglove::parse_request(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":7,"channelId":1}]})");
  ASSERT_TRUE(subscribe);
  EXPECT_THAT(subscribe->subscribe, ElementsAre(Pair(0U, 3U), Pair(7U, 1U)));
  const auto unsubscribe = foxglove::parse_request(R"({"op":"unsubscribe","subscriptionIds":[0,7]})");
  ASSERT_TRUE(unsubscribe);
  EXPECT_THAT(unsubscribe->unsubscribe, ElementsAre(0U, 7U));
  EXPECT_EQ(foxglove::parse_request(R"({"op":"getParameters","parameterNames":[]})")->kind,
            foxglove::Request::Kind::kOther);
}

TEST(Foxglove, RefusesWhatIsNone) {
  const std::string deep = R"({"op":)" + std::string(100000, '[') + std::string(100000, ']') + "}";
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("[]"), std::string("{}"), std::string(R"({"op":1})"),
        std::string(R"({"op":"subscribe"})"), std::string(R"({"op":"subscribe","subscriptions":7})"),
        std::string(R"({"op":"subscribe","subscriptions":[3]})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})"),
        std::string(R"({"op":"unsubscribe","subscriptionIds":["a"]})"), std::string("\xff\xfe\x00", 3), deep}) {
    EXPECT_FALSE(foxglove::parse_request(text)) << text.substr(0, 80);
  }
}

}  // namespace
}  // namespace coslam::foxglove_test
