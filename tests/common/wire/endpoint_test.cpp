// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Writers and loops over the real middleware, through the loopback device.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"
#include "common/wire/reply_parts.h"
#include "tests/support/eventually.h"
#include "tests/support/test_domain.h"
#include "tests/support/wire_equal.h"
#include "tests/support/wire_values.h"

namespace coslam::endpoint_test {
namespace {

using namespace std::chrono_literals;
using test::Collector;
using test::TestDomain;
using test::WireValues;

struct Note {
  WriterId writer;
  Presence presence;
};

// A participant with one loop that collects one topic.
template <class Message>
class Listener {
 public:
  explicit Listener(int domain, const std::string& partition = {})
      : participant_(loopback_config(domain), "listener"), loop_(participant_, "listener", 50ms, [] {}) {
    loop_.read<Message>(
        [this](const Message& m, const Sample& s) {
          samples.add(m);
          origins.add(s.writer);
        },
        [this](const WriterId& w, Presence p) {
          notes.add({w, p});
        },
        partition);
    loop_.start();
  }

  bool saw(Presence presence, std::size_t times = 1) {
    return notes.wait([&](const auto& all) {
      return std::ranges::count_if(all, [&](const Note& n) { return n.presence == presence; }) >=
             static_cast<long>(times);
    });
  }
  Participant& participant() { return participant_; }

  Collector<Message> samples;
  Collector<WriterId> origins;
  Collector<Note> notes;

 private:
  Participant participant_;
  Loop loop_;
};

template <class Message>
void wait_matched(const Writer<Message>& writer) {
  const auto end = std::chrono::steady_clock::now() + test::kDeadline;
  while (writer.readers() == 0 && std::chrono::steady_clock::now() < end) std::this_thread::yield();
  ASSERT_GT(writer.readers(), 0);
}

idl::Hello hello_of(int i) {
  return encode(WireValues(1).hello("cam" + std::to_string(i), RunId(100u + static_cast<unsigned>(i))));
}

TEST(Endpoint, LateJoinerGetsTheHello) {
  const TestDomain domain;
  Participant agent(loopback_config(domain.number()), "test");
  Writer<idl::Hello> writer(agent);
  EXPECT_GT(writer.write(hello_of(0)), 0u);
  Listener<idl::Hello> late(domain.number());
  ASSERT_TRUE(late.samples.wait_count(1));
  EXPECT_EQ(late.samples.values()[0], hello_of(0));
}

TEST(Endpoint, TwelveAgentsAreAllVisible) {
  const TestDomain domain;
  Listener<idl::Hello> server(domain.number());
  Participant agents(loopback_config(domain.number()), "test");
  std::vector<std::unique_ptr<Writer<idl::Hello>>> writers;
  for (int i = 0; i < 12; ++i) {
    writers.push_back(std::make_unique<Writer<idl::Hello>>(agents));
    writers.back()->write(hello_of(i));
  }
  ASSERT_TRUE(server.samples.wait([](const auto& all) {
    std::set<std::uint64_t> runs;
    for (const idl::Hello& h : all) runs.insert(h.agent_run());
    return runs.size() == 12;
  }));
}

TEST(Endpoint, OneWriterServesManyKeys) {
  const TestDomain domain;
  Listener<idl::Hello> server(domain.number());
  Participant agent(loopback_config(domain.number()), "test");
  Writer<idl::Hello> writer(agent);
  wait_matched(writer);
  for (int i = 0; i < 30; ++i) EXPECT_GT(writer.write(hello_of(i)), 0u) << "key " << i;
  EXPECT_TRUE(server.samples.wait_count(30));
}

TEST(Endpoint, MapPatchesArriveInOrderWithoutGaps) {
  constexpr std::uint32_t kPatches = 2000;
  constexpr std::uint32_t kWindow = 128;  // half the history, which keeps the newest 256
  const TestDomain domain;
  Listener<idl::MapPatch> agent(domain.number(), "run-1");
  Participant server(loopback_config(domain.number()), "test");
  Writer<idl::MapPatch> writer(server, "run-1");
  wait_matched(writer);
  WireValues values(3);
  for (std::uint32_t i = 1; i <= kPatches; ++i) {
    ASSERT_GT(writer.write(encode(values.map_patch("cam0", RunId(1), i, 40))), 0u);
    if (i > kWindow) {
      ASSERT_TRUE(agent.samples.wait_count(i - kWindow));
    }
  }
  ASSERT_TRUE(agent.samples.wait_count(kPatches));
  const auto received = agent.samples.values();
  for (std::uint32_t i = 0; i < kPatches; ++i) ASSERT_EQ(received[i].sequence_number(), i + 1);
}

TEST(Endpoint, PartitionsKeepPatchesApart) {
  const TestDomain domain;
  Listener<idl::MapPatch> one(domain.number(), "run-1");
  Listener<idl::MapPatch> two(domain.number(), "run-2");
  Participant server(loopback_config(domain.number()), "test");
  Writer<idl::MapPatch> to_one(server, "run-1"), to_two(server, "run-2");
  wait_matched(to_one);
  wait_matched(to_two);
  EXPECT_EQ(to_one.readers(), 1);
  WireValues values(4);
  to_one.write(encode(values.map_patch("one", RunId(1), 1, 5)));
  to_two.write(encode(values.map_patch("two", RunId(2), 1, 5)));
  ASSERT_TRUE(one.samples.wait_count(1));
  ASSERT_TRUE(two.samples.wait_count(1));
  EXPECT_EQ(one.samples.values()[0].agent().to_string(), "one");
  EXPECT_EQ(two.samples.values()[0].agent().to_string(), "two");
  EXPECT_EQ(one.participant().counts()[topic_index<idl::MapPatch>()].received, 1u);
}

TEST(Endpoint, ValuesAreTheSameAfterTheNetwork) {
  const TestDomain domain;
  Listener<idl::MapPatch> agent(domain.number());
  Participant server(loopback_config(domain.number()), "test");
  Writer<idl::MapPatch> writer(server);
  wait_matched(writer);
  const MapPatch sent = WireValues(5).map_patch("cam0", RunId(1), 7, 2048);
  writer.write(encode(sent));
  ASSERT_TRUE(agent.samples.wait_count(1)) << "fifty kilobytes, in fragments";
  auto received = decode(agent.samples.values()[0]);
  ASSERT_TRUE(received);
  test::expect_same(*received, sent);
}

TEST(Endpoint, BothEndsCountTheSameBytes) {
  const TestDomain domain;
  Listener<idl::AgentStatus> server(domain.number());
  Participant agent(loopback_config(domain.number()), "test");
  Writer<idl::AgentStatus> writer(agent);
  const idl::AgentStatus status = encode(WireValues(6).agent_status("cam0", RunId(1)));
  const std::uint64_t bytes = writer.write(status);
  EXPECT_EQ(bytes, link_bytes(sample_bytes(status), 1400));
  ASSERT_TRUE(server.samples.wait_count(1));
  const auto at = topic_index<idl::AgentStatus>();
  EXPECT_EQ(agent.counts()[at].sent, 1u);
  EXPECT_EQ(agent.counts()[at].sent_bytes, bytes);
  EXPECT_EQ(server.participant().counts()[at].received_bytes, bytes);
}

TEST(Endpoint, SilenceAndReturnAreNoticedPerWriter) {
  const TestDomain domain;
  Listener<idl::Hello> server(domain.number());
  Participant lively(loopback_config(domain.number()), "lively"), quiet(loopback_config(domain.number()), "quiet");
  Writer<idl::Hello> talker(lively), sleeper(quiet);
  talker.write(hello_of(0));
  sleeper.write(hello_of(1));
  ASSERT_TRUE(server.saw(Presence::kAlive, 2));
  // The talker keeps talking while the sleeper says nothing.
  const auto silent = [](const auto& all) {
    return std::ranges::any_of(all, [](const Note& n) { return n.presence == Presence::kSilent; });
  };
  {
    const std::jthread heart([&](std::stop_token stop) {
      while (!stop.stop_requested()) {
        talker.assert_alive();
        std::this_thread::sleep_for(50ms);
      }
    });
    ASSERT_TRUE(server.notes.wait(silent));
  }
  const auto notes = server.notes.values();
  const auto note = std::ranges::find_if(notes, [](const Note& n) { return n.presence == Presence::kSilent; });
  ASSERT_TRUE(server.samples.wait_count(2));
  const auto hellos = server.samples.values();
  const auto origins = server.origins.values();
  const std::size_t sleeper_at = hellos[0].agent().to_string() == "cam1" ? 0 : 1;
  EXPECT_EQ(note->writer, origins[sleeper_at]) << "the one that said nothing";
  sleeper.assert_alive();
  EXPECT_TRUE(server.saw(Presence::kAlive, 3)) << "and it is back";
}

TEST(Endpoint, EndIsNoticedAfterTheLastSample) {
  const TestDomain domain;
  Listener<idl::AgentStatus> server(domain.number());
  Participant agent(loopback_config(domain.number()), "test");
  {
    Writer<idl::AgentStatus> writer(agent);
    wait_matched(writer);
    writer.write(encode(WireValues(7).agent_status("cam0", RunId(1), AgentState::kFinished)));
  }
  ASSERT_TRUE(server.saw(Presence::kGone));
  EXPECT_EQ(server.samples.values().size(), 1u) << "what was written last arrived first";
}

TEST(Endpoint, PacedTopicsArriveWhole) {
  const TestDomain domain;
  WireConfig paced = loopback_config(domain.number());
  paced.bulk_bytes_per_s = 2'000'000;
  Listener<idl::PatchReply> server(domain.number());
  Participant agent(paced, "test");
  Writer<idl::PatchReply> writer(agent);
  wait_matched(writer);
  WireValues values(8);
  const TrackFrame frame = values.frame("cam0", RunId(1), 1, 0);
  for (const PatchReply& part : in_parts(values.patches(frame, 800))) writer.write(encode(part));
  EXPECT_TRUE(server.samples.wait_count(50));
}

}  // namespace
}  // namespace coslam::endpoint_test
