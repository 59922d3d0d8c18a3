// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Participants with and without the fleet's key, and what strangers can do to them with a plain socket.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <random>
#include <thread>

#include "common/base/log.h"
#include "common/wire/codec.h"
#include "common/wire/loop.h"
#include "common/wire/participant.h"
#include "common/wire/ports.h"
#include "tests/common/wire/plain_socket.h"
#include "tests/support/child_process.h"
#include "tests/support/eventually.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_domain.h"
#include "tests/support/wire_values.h"

namespace coslam::guarded_transport_test {
namespace {

using namespace std::chrono_literals;
using test::Octets;
using test::Socket;
using testing::Contains;
using testing::IsEmpty;
using testing::IsSupersetOf;

constexpr int kUnused = 31;         // participants are numbered from 0; all announce themselves to this one too
constexpr std::uint64_t kSome = 5;  // announcements: enough to be sure that they arrive

template <class Condition>
bool eventually(Condition condition) {
  const auto end = std::chrono::steady_clock::now() + test::kDeadline;
  while (!condition() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(5ms);
  return condition();
}

class GuardedTransport : public ::testing::Test {
 protected:
  std::string key_file(const std::string& secret) const {
    const std::string file = folder_.write(secret, secret).string();
    chmod(file.c_str(), 0600);
    return file;
  }
  WireConfig with_key(const std::string& secret = "the secret of this fleet") const {
    WireConfig config = without_key();
    config.key_file = key_file(secret);
    return config;
  }
  WireConfig without_key() const { return loopback_config(domain_.number()); }
  // Where the participant of this number listens for announcements; for data, one higher.
  std::uint16_t port(int participant) const {
    return static_cast<std::uint16_t>(unicast_port(domain_.number(), participant));
  }

  test::TestDomain domain_;
  test::TempFolder folder_;
};

Octets rtps_header() { return {'R', 'T', 'P', 'S', 2, 3, 1, 15, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}; }

// The statistics that Debian's build of Fast DDS appends to each datagram, twice: it expects them at the end, and its
// assert stops the process where they are not.
Octets crafted() {
  Octets out = rtps_header();
  for (int i = 0; i < 2; ++i) {
    out.insert(out.end(), {0x80, 0, 0, 56});
    out.insert(out.end(), 56, 0);
  }
  return out;
}

// Submessages of any kind, length and content.
Octets nonsense(std::mt19937& random) {
  Octets out = rtps_header();
  for (unsigned i = 0; i < 1 + random() % 4; ++i) {
    constexpr std::array<std::uint8_t, 13> kKinds = {0x01, 0x06, 0x07, 0x08, 0x09, 0x0c, 0x0d,
                                                     0x0e, 0x0f, 0x12, 0x13, 0x15, 0x16};
    const auto length = static_cast<std::uint8_t>(random() % 200);
    out.insert(out.end(), {kKinds[random() % kKinds.size()], static_cast<std::uint8_t>(random()), length, 0});
    for (unsigned k = 0; k < length; ++k) out.push_back(static_cast<std::uint8_t>(random()));
  }
  return out;
}

Octets mutated(Octets octets, std::mt19937& random) {
  for (unsigned i = 0; i < 1 + random() % 8; ++i) {
    octets[random() % octets.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
  }
  if (random() % 3 == 0) octets.resize(random() % octets.size() + 1);
  while (random() % 4 == 0) octets.push_back(static_cast<std::uint8_t>(random()));
  return octets;
}

// Statuses from one participant to another.
class Talk {
 public:
  Talk(Participant& from, Participant& to) : writer_(from), loop_(to, "listener", 50ms, [] {}) {
    loop_.read<idl::AgentStatus>([this](const idl::AgentStatus& m, const Sample&) { received_.add(m); });
    loop_.start();
  }
  bool works() {
    const std::size_t before = received_.values().size();
    return eventually([&] {
      writer_.write(encode(test::WireValues(6).agent_status("cam0", RunId(1))));
      return received_.values().size() > before;
    });
  }

 private:
  Writer<idl::AgentStatus> writer_;
  test::Collector<idl::AgentStatus> received_;
  Loop loop_;
};

TEST_F(GuardedTransport, WhoHasTheKeyIsHeard) {
  Participant agent(with_key(), "agent"), server(with_key(), "server");
  EXPECT_TRUE(Talk(agent, server).works());
  EXPECT_THAT(agent.others(), Contains("server"));
  EXPECT_THAT(server.others(), Contains("agent"));
}

TEST_F(GuardedTransport, ManySamplesOfAllSizesArriveUnharmed) {
  Participant agent(with_key(), "agent"), server(with_key(), "server");
  test::Collector<idl::MapPatch> received;
  Loop loop(agent, "listener", 50ms, [] {});
  loop.read<idl::MapPatch>([&](const idl::MapPatch& m, const Sample&) { received.add(m); }, {}, "run-1");
  loop.start();
  Writer<idl::MapPatch> writer(server, "run-1");
  ASSERT_TRUE(eventually([&] { return writer.readers() > 0; }));
  test::WireValues values(3);
  std::vector<idl::MapPatch> sent;
  for (std::uint32_t i = 1; i <= 400; ++i) {
    sent.push_back(encode(values.map_patch("cam0", RunId(1), i, static_cast<int>(i))));  // 1 to 15 datagrams
    const std::uint64_t bytes = writer.write(sent.back());
    EXPECT_EQ(bytes, link_bytes(sample_bytes(sent.back()), 1400, true));
    if (i > 16) {
      ASSERT_TRUE(received.wait_count(i - 16));
    }
  }
  ASSERT_TRUE(received.wait_count(sent.size()));
  EXPECT_EQ(received.values(), sent);
  for (const Participant* participant : {&agent, &server}) {
    EXPECT_EQ(participant->rejections().total(), 0u) << "every seal was whole and new";
  }
}

TEST_F(GuardedTransport, StrangersAreNotSeenAndSeeNobody) {
  const Participant ours(with_key(), "ours"), theirs(with_key("the secret of another fleet"), "theirs");
  const Participant open(without_key(), "open");
  for (const Participant* participant : {&ours, &theirs}) {
    EXPECT_TRUE(eventually([&] { return participant->rejections()[Rejection::kUnauthentic] >= 2 * kSome; }));
  }
  for (const Participant* participant : {&ours, &theirs, &open}) EXPECT_THAT(participant->others(), IsEmpty());
  const auto said = [](const std::string& what) {
    return testing::Field(&Warning::text, testing::StartsWith("datagrams " + what + " arrive, the last one from 127."));
  };
  EXPECT_THAT(warnings_given(), IsSupersetOf({said("without a key"), said("with another key than the fleet's")}));
}

TEST_F(GuardedTransport, DatagramsStayBelowTheirBound) {
  const Socket recorder(port(kUnused));
  const Participant participant(with_key(), "test");
  for (std::uint64_t i = 0; i < kSome; ++i) {
    const Octets announcement = recorder.receive();
    EXPECT_GT(announcement.size(), 300u);
    EXPECT_LE(announcement.size(), 1400u);
    EXPECT_NE(announcement[0], 'R') << "nothing that looks like RTPS";
  }
}

TEST_F(GuardedTransport, ARecordedDatagramIsHeardOnce) {
  const Socket recorder(port(kUnused));
  const Participant ours(with_key(), "ours");
  Octets recorded;
  {
    const Participant other(with_key(), "other");
    ASSERT_TRUE(eventually([&] { return ours.others() == std::vector<std::string>{"other"}; }));
    recorded = recorder.receive();
  }
  const Socket stranger;
  for (int i = 0; i < 3; ++i) stranger.send(recorded, port(0));
  EXPECT_TRUE(eventually([&] { return ours.rejections()[Rejection::kReplayed] == 2; }));
  EXPECT_EQ(ours.rejections()[Rejection::kUnauthentic], 0u);
}

TEST_F(GuardedTransport, NonsenseIsCountedAndTheRestGoesOn) {
  Octets open_announcement, sealed_announcement;
  {
    const Socket recorder(port(kUnused));
    {
      const Participant open(without_key(), "open");
      open_announcement = recorder.receive();
    }
    ASSERT_EQ(std::string(open_announcement.begin(), open_announcement.begin() + 4), "RTPS");
    const Participant other(with_key(), "other");
    sealed_announcement = recorder.receive();
    while (!sealed_announcement.empty() && sealed_announcement[0] == 'R') sealed_announcement = recorder.receive();
    ASSERT_FALSE(sealed_announcement.empty());
  }
  Participant agent(with_key(), "agent"), server(with_key(), "server");
  Talk talk(agent, server);
  ASSERT_TRUE(talk.works());

  constexpr std::uint64_t kRounds = 3000;
  const Socket stranger;
  std::mt19937 random(1);
  for (std::uint64_t round = 0; round < kRounds; ++round) {
    for (const std::uint16_t at : {port(1), static_cast<std::uint16_t>(port(1) + 1)}) {
      stranger.send(crafted(), at);
      stranger.send(nonsense(random), at);
      stranger.send(mutated(crafted(), random), at);
      stranger.send(mutated(open_announcement, random), at);
      stranger.send(mutated(sealed_announcement, random), at);
    }
    if (round % 50 == 0) std::this_thread::sleep_for(1ms);  // or the socket overflows
  }
  EXPECT_TRUE(eventually([&] { return server.rejections()[Rejection::kUnauthentic] >= 5 * kRounds; }))
      << server.rejections()[Rejection::kUnauthentic] << " of " << 10 * kRounds;
  EXPECT_TRUE(talk.works());
}

// How a process without or with the key ends that hears the crafted datagram for three seconds; nothing when it lives.
std::optional<int> end_of_child(const WireConfig& config, std::uint16_t port) {
  const Participant watch(config, "watch");  // takes the first ports
  std::vector<std::string> command = {PARTICIPANT_CHILD, std::to_string(config.domain)};
  if (!config.key_file.empty()) command.push_back(config.key_file);
  test::ChildProcess child(command);
  EXPECT_TRUE(eventually([&] { return watch.others() == std::vector<std::string>{"child"}; }));
  const Socket stranger;
  for (int i = 0; i < 30; ++i) {
    stranger.send(crafted(), port);
    if (const auto status = child.wait_for(100ms)) return status;
  }
  EXPECT_EQ(watch.others(), std::vector<std::string>{"child"}) << "alive";
  return std::nullopt;
}

TEST_F(GuardedTransport, WithoutKeyOneDatagramStopsAProcess) {
  const std::optional<int> status = end_of_child(without_key(), port(1));
  if (!status) GTEST_SKIP() << "this build of Fast DDS is not stopped by the crafted datagram";
  EXPECT_TRUE(WIFSIGNALED(*status) && WTERMSIG(*status) == SIGABRT) << *status;
}

TEST_F(GuardedTransport, WithKeyItDoesNot) { EXPECT_EQ(end_of_child(with_key(), port(1)), std::nullopt); }

}  // namespace
}  // namespace coslam::guarded_transport_test
