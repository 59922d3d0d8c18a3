// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/record/recorded_event.h"

#include <gmock/gmock.h>

#include <random>

#include "common/wire/codec.h"
#include "tests/support/wire_equal.h"
#include "tests/support/wire_values.h"

namespace coslam::recorded_event_test {
namespace {

using test::expect_same;
using test::WireValues;
using ::testing::HasSubstr;

const RunId kRun(9);

template <class Event>
Event round_trip(const Event& event) {
  const Record record = encode_event(event, 5);
  EXPECT_EQ(record.t_ns, 5);
  const auto decoded = decode_event(record);
  if (!decoded || !std::holds_alternative<Event>(*decoded)) {
    ADD_FAILURE() << "no such event";
    return {};
  }
  return std::get<Event>(*decoded);
}

// As a link gives it: values that a decoder made.
JoinedFrame joined(WireValues& values, std::uint32_t number, int tracks) {
  JoinedFrame joined{values.frame("cam0", kRun, number, tracks), {}, {}};
  joined.patches = values.patches(joined.frame, 40);
  joined.descriptors = values.descriptors(joined.frame, 60);
  return joined;
}

TEST(RecordedEvent, IsEqualToTheBit) {
  WireValues values(1);
  const Hello hello = values.hello("cam0", kRun);
  expect_same(round_trip(hello), hello);
  for (const int tracks : {0, 1, 300, 2048}) {
    const JoinedFrame frame = joined(values, 5, tracks);
    const JoinedFrame again = round_trip(frame);
    expect_same(again.frame, frame.frame);
    expect_same(*again.patches, *frame.patches);
    expect_same(*again.descriptors, *frame.descriptors);
  }
  AgentStatus status = values.agent_status("cam0", kRun, AgentState::kFinished);
  status.exchange = {1, 2, 3, 4};
  const AgentStatus status_again = round_trip(status);
  expect_same(status_again, status);
  EXPECT_EQ(status_again.exchange.arrived_ns, 4) << "not on the wire";
  EXPECT_EQ(round_trip(AgentSilent{"cam0", kRun}).agent, "cam0");
  EXPECT_EQ(round_trip(AgentGone{"cam1", kRun}).agent_run, kRun);
}

// On whatever grid the agent's camera has, which the event does not tell.
TEST(RecordedEvent, KeepsCoordinatesOfAnyCamera) {
  for (int bits = -1; bits <= 10; ++bits) {
    JoinedFrame frame{WireValues(3).frame("cam0", kRun, 0, 0), {}, {}};
    frame.frame.tracks.push_back({TrackId(1), {std::ldexp(32767.0F, -bits), std::ldexp(-32767.0F, -bits)}});
    frame.frame.tracks.push_back({TrackId(2), {std::ldexp(1.0F, -bits), 0}});
    expect_same(round_trip(frame).frame, frame.frame);
  }
}

TEST(RecordedEvent, RepliesMayBeMissingOrOfAnEarlierFrame) {
  WireValues values(2);
  JoinedFrame frame = joined(values, 5, 10);
  frame.patches.reset();
  frame.descriptors->frame = FrameId(3);
  const JoinedFrame again = round_trip(frame);
  EXPECT_FALSE(again.patches.has_value());
  EXPECT_EQ(again.descriptors->frame, FrameId(3));
  frame.descriptors->frame = FrameId(6);
  EXPECT_FALSE(decode_event(encode_event(frame, 0))) << "no link gives a reply before its frame";
  frame = joined(values, 5, 10);
  frame.patches->agent = "cam1";
  EXPECT_FALSE(decode_event(encode_event(frame, 0)));
}

// Octets from a stranger make a usable event or none, and never a crash.
TEST(RecordedEvent, TrustsNothing) {
  WireValues values(4);
  std::mt19937 random(12345);
  const std::vector<ServerEvent> events{values.hello("cam0", kRun), joined(values, 5, 40),
                                        values.agent_status("cam0", kRun, AgentState::kFinished),
                                        AgentSilent{"cam0", kRun}, AgentGone{"cam0", kRun}};
  const auto usable = [](const Record& record) {
    const auto event = decode_event(record);
    EXPECT_TRUE(!event || decode_event(encode_event(*event, 0))) << "what passed once passes again";
    return event.has_value();
  };
  for (const ServerEvent& event : events) {
    const Record good = encode_event(event, 0);
    for (int i = 0; i < 2000; ++i) {
      Record bad = good;
      for (int flips = 1 + i % 4; flips > 0; --flips)
        bad.payload[random() % bad.payload.size()] = static_cast<std::uint8_t>(random());
      usable(bad);
    }
    const bool any_length = event.index() >= 3;  // a shorter name is a name
    for (std::size_t size = 0; size < std::min<std::size_t>(good.payload.size(), 600); ++size) {
      const bool good_still =
          usable({good.type, 0, {good.payload.begin(), good.payload.begin() + static_cast<long>(size)}});
      EXPECT_TRUE(any_length || !good_still) << size;
    }
    Record longer = good;
    longer.payload.push_back(0);
    EXPECT_FALSE(usable(longer));
    for (int type = 0; type <= static_cast<int>(RecordType::kEnd); ++type) {
      usable({static_cast<RecordType>(type), 0, good.payload});
    }
  }
  EXPECT_FALSE(decode_event({RecordType::kEnd, 0, {}}));
  Hello foreign = values.hello("cam0", kRun);
  foreign.protocol = kProtocolVersion + 1;
  EXPECT_FALSE(decode_event(encode_event(foreign, 0))) << "a link turns it away";
}

TEST(RecordedHead, IsJson) {
  const RecordingHead head{"1.2.3", RunId(UINT64_MAX), 1'700'000'000'000'000'000, 5, {{"server", {{"theta", 2.1}}}}};
  const Record record = encode_head(head);
  const auto again = decode_head(record);
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(again->version, head.version);
  EXPECT_EQ(again->server_run, head.server_run);
  EXPECT_EQ(again->utc_ns, head.utc_ns);
  EXPECT_EQ(again->monotonic_ns, head.monotonic_ns);
  EXPECT_EQ(again->configuration, head.configuration);
  EXPECT_FALSE(foreign_protocol(record));
}

TEST(RecordedHead, TrustsNothing) {
  const auto of = [](const std::string& text) { return Record{RecordType::kHead, 0, {text.begin(), text.end()}}; };
  const std::string good = R"({"server_run":1,"utc_ns":1,"monotonic_ns":1,"configuration":{}})";
  ASSERT_TRUE(decode_head(of(good)));
  EXPECT_FALSE(decode_head({RecordType::kHello, 0, of(good).payload}));
  const std::string deep = std::string(100000, '[') + std::string(100000, ']');
  const std::vector<std::string> nonsense{"",
                                          "{",
                                          "[]",
                                          deep,
                                          "\xff\xfe",
                                          R"({"server_run":1,"configuration":[]})",
                                          R"({"server_run":0,"configuration":{}})",
                                          R"({"server_run":1,"utc_ns":-1,"configuration":{}})",
                                          R"({"server_run":1,"configuration":)" + deep + "}"};
  for (const std::string& bad : nonsense) {
    EXPECT_FALSE(decode_head(of(bad))) << bad.substr(0, 50);
    EXPECT_FALSE(foreign_protocol(of(bad)));
  }
  EXPECT_THAT(foreign_protocol(of(R"({"protocol":1})")).value_or(""), HasSubstr("messages of protocol 1"));
}

}  // namespace
}  // namespace coslam::recorded_event_test
