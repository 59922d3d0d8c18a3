// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/fleet.h"

#include "common/model/session.h"
#include "deploy/coslam/doctor/hearing.h"
#include "deploy/coslam/doctor/udp.h"
#include "tests/deploy/coslam/doctor/said.h"

namespace coslam::doctor::fleet_test {
namespace {

using std::chrono::milliseconds;
using ::testing::Each;
using ::testing::Field;

constexpr std::uint32_t kThere = 0x0a580001;  // 10.88.0.1

Voice voice(const std::string& name, std::uint32_t address = kThere) {
  Voice v{.name = name, .address = address, .announced = true, .by_multicast = true, .heard_ours = true};
  v.protocol = kProtocolVersion;
  v.roads.push_back({{address, 9160}, 10, 10, 10, 10, 0.4, 0.001});
  return v;
}

// A server and an agent that are well, seen from eth0.
FleetFacts well() {
  FleetFacts facts{.domain = 7};
  facts.asked_by = {{.name = "eth0", .addresses = {"10.88.0.3"}, .index = 2}};
  facts.came_back = {2};
  facts.own_port = 9162;
  facts.voices = {voice("coslam-server"), voice("coslam-agent left", kThere + 1)};
  return facts;
}

TEST(DoctorFleet, WhatIsWell) {
  const Findings said = judge(well());
  EXPECT_THAT(said, Each(Field(&Finding::grade, Grade::kOk)));
  ASSERT_EQ(said.size(), 3U);
  EXPECT_EQ(said[1].subject, "map server");
  EXPECT_THAT(said[1],
              Says(Grade::kOk, "10.88.0.1, protocol 14, no key, 0.4 ms there and back, 20 of 20 answered", ""));
  EXPECT_EQ(said[2].subject, "agent left");
}

TEST(DoctorFleet, NobodyAndWhoIsNextDoor) {
  FleetFacts facts = well();
  facts.voices.clear();
  EXPECT_THAT(first_of(judge(facts)),
              Says(Grade::kWarn, "nobody is heard in domain 7 (listened on 10.88.0.3)", "--peer"));
  facts.next_door = {{8, "coslam-server", kThere}, {0, "talker", kThere}};
  EXPECT_THAT(first_of(judge(facts)),
              Says(Grade::kFail, "map server in domain 8 at 10.88.0.1, and nobody in domain 7", "--domain 8"));
  facts.voices = well().voices;
  EXPECT_THAT(judge(facts), Each(Field(&Finding::grade, Grade::kOk)));
}

TEST(DoctorFleet, MulticastDoesNotComeBack) {
  FleetFacts facts = well();
  facts.came_back.clear();
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kFail, "does not come back", "dev eth0"));
}

TEST(DoctorFleet, OneWayOnly) {
  FleetFacts facts = well();
  Road& road = facts.voices[0].roads[0];
  road.answered = road.answered_at_port = 0;
  facts.voices[0].heard_ours = false;
  EXPECT_THAT(first_of(judge(facts)),
              Says(Grade::kFail, "does not answer at 10.88.0.1 on UDP 9160: a firewall", "dport 9150-9399"));
  road.answered = 10;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kFail, "not on UDP 9162: a firewall on this machine", "nft"));
}

TEST(DoctorFleet, Keys) {
  FleetFacts facts = well();
  facts.voices.clear();
  facts.sealed_by_others = {kThere};
  EXPECT_THAT(first_of(judge(facts)),
              Says(Grade::kFail, "10.88.0.1 seals its datagrams: this machine has no key", "wire.key_file"));
  facts.key_file = "fleet.key";
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kFail, "with another key than fleet.key", "wire.key_file"));
  facts = well();
  facts.key_file = "fleet.key";
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kFail, "it has no key, this machine has", "wire.key_file"));
  for (Voice& v : facts.voices) v.seal = Seal::kOurs;
  EXPECT_THAT(judge(facts)[1], Says(Grade::kOk, "with the key", ""));
}

TEST(DoctorFleet, OtherVersionsClocksAndLosses) {
  FleetFacts facts = well();
  facts.voices[1].protocol = 13;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kFail, "protocol 13, this machine 14", "same version"));
  facts = well();
  facts.voices[0].roads[0].clock_ahead_s = -5;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "5 s behind", "timedatectl"));
  facts = well();
  facts.voices[0].roads[0].answered = 5;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "5 of 20 questions", "link"));
}

TEST(DoctorFleet, NamesThatAreThereTwice) {
  FleetFacts facts = well();
  facts.voices.push_back(voice("coslam-server", kThere + 2));
  EXPECT_THAT(first_of(judge(facts)),
              Says(Grade::kFail, "there are 2 in domain 7, at 10.88.0.1 and 10.88.0.3", "stop one"));
  facts = well();
  facts.voices.push_back(voice("coslam-agent left"));
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kFail, "there are 2", "--id"));
  facts = well();
  facts.voices.erase(facts.voices.begin());
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "none is heard in domain 7", "coslam-server --domain 7"));
  facts = well();
  facts.voices.push_back(voice("talker"));
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "no program of the fleet", "--domain"));
}

Finding of_called(const Called& called) {
  FleetFacts facts = well();
  facts.called = {called};
  return first_of(judge(facts));
}

TEST(DoctorFleet, HostsThatAreCalled) {
  EXPECT_THAT(of_called({"base", "peer 'base' is no IPv4 address", {}}), Says(Grade::kFail, "peer 'base'", "getent"));
  EXPECT_THAT(of_called({"base", "", {kThere}, false, ECONNREFUSED}),
              Says(Grade::kFail, "nothing runs in domain 7 at 10.88.0.1: UDP 9160", "coslam-server --domain 7"));
  EXPECT_THAT(of_called({"base", "", {kThere}, false, ENETUNREACH}), Says(Grade::kFail, "no route", "ip route"));
  EXPECT_THAT(of_called({"base", "", {kThere}, false, EHOSTUNREACH}), Says(Grade::kFail, "no machine answers", "ping"));
  EXPECT_THAT(of_called({"base", "", {kThere}, false, EPERM}), Says(Grade::kFail, "forbids", "nft"));
  EXPECT_THAT(of_called({"base", "", {kThere}, false, {}}), Says(Grade::kFail, "nothing comes back", "coslam doctor"));
  EXPECT_EQ(of_called({"base", "", {kThere}, true, {}}).grade, Grade::kOk);
}

TEST(DoctorFleet, MulticastDoesNotPass) {
  FleetFacts facts = well();
  facts.called = {{"10.88.0.1", "", {kThere}, true, {}}};
  facts.voices[0].by_multicast = facts.voices[0].heard_ours = false;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "no multicast passes", "wire.peers=[10.88.0.1]"));
}

TEST(Hearing, MakesVoicesOfAnnouncementsAndAnswers) {
  FleetFacts facts;
  facts.called = {{"server", "", {kThere}, false, ECONNREFUSED}};
  Hearing hearing(facts);
  const Instant start;
  const Ipv4Endpoint called{kThere, 9160}, other{kThere + 1, 9160};
  hearing.call(called);
  EXPECT_THAT(hearing.endpoints(), ::testing::ElementsAre(called));
  EXPECT_TRUE(hearing.is_silent(called));
  const auto number = hearing.ask(Hearing::Way::kBack, called, start);
  hearing.answered({number, to_ns(105), 14, "coslam-server"}, kThere, Seal::kNone, start + milliseconds(20),
                   to_ns(100));
  ASSERT_EQ(facts.voices.size(), 1U);
  EXPECT_EQ(facts.voices[0].name, "coslam-server");
  EXPECT_EQ(facts.voices[0].roads[0].asked, 1);
  EXPECT_EQ(facts.voices[0].roads[0].answered, 1);
  EXPECT_NEAR(facts.voices[0].roads[0].least_ms, 20, 1e-9);
  EXPECT_NEAR(facts.voices[0].roads[0].clock_ahead_s, 5.01, 1e-9);
  EXPECT_TRUE(facts.called[0].heard);
  EXPECT_FALSE(hearing.is_silent(called));

  hearing.announced({{1}, {1, 15}, "coslam-agent left", {other}}, kThere + 1, Seal::kNone, true);
  hearing.announced({{1}, {1, 15}, "coslam-agent left", {other}}, kThere + 1, Seal::kNone, true);
  ASSERT_EQ(facts.voices.size(), 2U);
  EXPECT_THAT(hearing.endpoints(), ::testing::ElementsAre(called, other));
  const auto to_all = hearing.ask(Hearing::Way::kMulticast, {0, 9150}, start);
  hearing.answered({to_all, 0, 14, "coslam-agent left"}, kThere + 1, Seal::kNone, start, 0);
  EXPECT_TRUE(facts.voices[1].heard_ours);
  EXPECT_FALSE(facts.voices[0].heard_ours);
  hearing.answered({77, 0, 14, "who is this"}, kThere, Seal::kNone, start, 0);  // to a question that was not asked
  EXPECT_EQ(facts.voices.size(), 2U);
}

TEST(Hearing, APortIsClosed) {
  FleetFacts facts;
  facts.called = {{"server", "", {kThere}, false, {}}};
  Hearing hearing(facts);
  hearing.call({kThere, 9160});
  hearing.call({kThere, 9162});
  hearing.undelivered({kThere, 9162}, ECONNREFUSED);  // somebody may be at the lower one
  EXPECT_FALSE(facts.called[0].error);
  hearing.undelivered({kThere, 9160}, ECONNREFUSED);
  EXPECT_EQ(facts.called[0].error, ECONNREFUSED);
}

TEST(Hearing, OneThatIsCalledAndAnnouncesItselfIsOne) {
  FleetFacts facts;
  Hearing hearing(facts);
  const Ipv4Endpoint called{kThere, 9160};
  hearing.call(called);
  const auto number = hearing.ask(Hearing::Way::kBack, called, {});
  hearing.announced({{1}, {1, 15}, "coslam-server", {called}}, kThere, Seal::kNone, true);
  hearing.answered({number, 0, 14, "coslam-server"}, kThere, Seal::kNone, {}, 0);
  ASSERT_EQ(facts.voices.size(), 1U);
  EXPECT_EQ(facts.voices[0].roads.size(), 1U);
  EXPECT_EQ(facts.voices[0].roads[0].asked, 1);
  // The other way round.
  FleetFacts later;
  Hearing again(later);
  again.call(called);
  const auto first = again.ask(Hearing::Way::kBack, called, {});
  again.answered({first, 0, 14, "coslam-server"}, kThere, Seal::kNone, {}, 0);
  again.announced({{1}, {1, 15}, "coslam-server", {called}}, kThere, Seal::kNone, true);
  EXPECT_EQ(later.voices.size(), 1U);
}

}  // namespace
}  // namespace coslam::doctor::fleet_test
