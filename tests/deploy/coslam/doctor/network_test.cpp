// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/network.h"

#include "common/wire/ports.h"
#include "deploy/coslam/doctor/udp.h"
#include "tests/deploy/coslam/doctor/said.h"
#include "tests/support/all_ports.h"
#include "tests/support/test_domain.h"

namespace coslam::doctor::network_test {
namespace {

using ::testing::Each;
using ::testing::Field;

const Interface kLoopback{
    .name = "lo", .addresses = {"127.0.0.1"}, .index = 1, .up = true, .carrier = true, .loopback = true, .mtu = 65536};
const Interface kCable{
    .name = "eth0", .addresses = {"10.0.0.5"}, .index = 2, .up = true, .carrier = true, .multicast = true, .mtu = 1500};

Interface changed(Interface i, bool Interface::*field) {
  i.*field = !(i.*field);
  return i;
}

Finding first_of_cable(const Interface& cable, const WireConfig& wire = {}) {
  return first_of(judge(std::vector{kLoopback, cable}, wire));
}

TEST(DoctorNetwork, WhatIsInOrder) {
  EXPECT_THAT(judge(std::vector{kLoopback, kCable}, {}), Each(Field(&Finding::grade, Grade::kOk)));
  EXPECT_THAT(judge(std::vector{kLoopback}, loopback_config(0)), Each(Field(&Finding::grade, Grade::kOk)));
}

TEST(DoctorNetwork, NoWayOut) {
  EXPECT_THAT(first_of_cable(changed(kCable, &Interface::up)),
              Says(Grade::kFail, "it is down", "sudo ip link set eth0 up"));
  EXPECT_THAT(first_of_cable(changed(kCable, &Interface::carrier)), Says(Grade::kFail, "no carrier", "cable"));
  Interface bare = kCable;
  bare.addresses.clear();
  EXPECT_THAT(first_of_cable(bare), Says(Grade::kFail, "no IPv4 address", "dhclient eth0"));
  EXPECT_THAT(first_of(judge(std::vector{kLoopback}, {})), Says(Grade::kFail, "none leads out", "ip -brief link"));
}

TEST(DoctorNetwork, OneOfSeveralMayBeDown) {
  Interface radio = changed(kCable, &Interface::up);
  radio.name = "wlan0";
  const Findings said = judge(std::vector{kLoopback, kCable, radio}, {});
  EXPECT_THAT(said, Each(Field(&Finding::grade, Grade::kOk)));
  EXPECT_THAT(said.back(), Says(Grade::kOk, "left aside: it is down", ""));
}

TEST(DoctorNetwork, ChosenInterfaces) {
  WireConfig wire;
  wire.interfaces = {"10.0.0.6"};
  EXPECT_THAT(first_of_cable(kCable, wire), Says(Grade::kFail, "10.0.0.6, which this machine has not", "ip -brief"));
  wire.interfaces = {"10.0.0.5"};
  EXPECT_EQ(first_of_cable(kCable, wire).grade, Grade::kOk);
  EXPECT_EQ(use_of(kLoopback, wire).why_not, "wire.interfaces names 10.0.0.5");
}

TEST(DoctorNetwork, SmallDatagramsAndNoMulticast) {
  Interface tunnel = kCable;
  tunnel.mtu = 1280;
  EXPECT_THAT(first_of_cable(tunnel), Says(Grade::kWarn, "MTU 1280", "wire.max_message_bytes=1252"));
  const Interface mute = changed(kCable, &Interface::multicast);
  EXPECT_THAT(first_of_cable(mute), Says(Grade::kWarn, "no multicast", "wire.peers"));
  WireConfig wire;
  wire.peers = {"10.0.0.1"};
  EXPECT_EQ(first_of_cable(mute, wire).grade, Grade::kOk);
}

TEST(DoctorNetwork, Ports) {
  const WireConfig wire;
  PortFacts facts{.domain = 7};
  EXPECT_THAT(first_of(judge(facts, wire)), Says(Grade::kOk, "UDP 9150 to 9399 of domain 7: free", ""));
  facts.held = {{0, "coslam-server", 12}};
  EXPECT_THAT(first_of(judge(facts, wire)), Says(Grade::kOk, "1 participant of the fleet", ""));
  facts.held.push_back({1, "talker", 13});
  EXPECT_THAT(first_of(judge(facts, wire)), Says(Grade::kWarn, "UDP 9162 is held by talker (process 13)", "--domain"));
  for (int i = 2; i < 32; ++i) facts.held.push_back({i, {}, 0});
  EXPECT_THAT(first_of(judge(facts, wire)), Says(Grade::kFail, "no UDP port of domain 7 is free", "--domain"));
  facts.multicast_bindable = false;
  EXPECT_THAT(first_of(judge(facts, wire)), Says(Grade::kFail, "UDP 9150", "--domain"));
}

TEST(DoctorNetwork, PortsOfThisTest) {
  const test::TestDomain domain;
  EXPECT_TRUE(look_at_ports(domain.number()).multicast_bindable);
  EXPECT_TRUE(look_at_ports(domain.number()).held.empty());
  const test::AllPorts all(domain.number());
  const PortFacts facts = look_at_ports(domain.number());
  EXPECT_FALSE(facts.multicast_bindable);
  ASSERT_EQ(facts.held.size(), static_cast<std::size_t>(kMostPerHost));
  EXPECT_EQ(facts.held.front().pid, getpid());
  EXPECT_NE(facts.held.front().program, "");
}

TEST(DoctorNetwork, InterfacesOfThisTest) {
  const auto all = look_at_interfaces();
  const auto loopback = std::ranges::find_if(all, &Interface::loopback);
  ASSERT_NE(loopback, all.end());
  EXPECT_THAT(loopback->addresses, ::testing::Contains("127.0.0.1"));
  EXPECT_GT(loopback->mtu, 1500);
}

TEST(Udp, TellsWhatTheNetworkAnswers) {
  const test::TestDomain domain;
  const Udp asks;
  const Ipv4Endpoint closed{INADDR_LOOPBACK, static_cast<std::uint16_t>(unicast_port(domain.number(), 3))};
  ASSERT_TRUE(asks.send(std::vector<std::uint8_t>{1, 2}, closed));
  const auto lost = asks.undelivered();
  ASSERT_TRUE(lost);
  EXPECT_EQ(lost->to, closed);
  EXPECT_EQ(lost->error, ECONNREFUSED);
  Udp hears;
  ASSERT_TRUE(hears.bind(closed.port));
  ASSERT_TRUE(asks.send(std::vector<std::uint8_t>{1, 2, 3}, closed));
  const auto received = hears.receive();
  ASSERT_TRUE(received);
  EXPECT_EQ(received->octets.size(), 3U);
  EXPECT_EQ(text_of(received->from.address), "127.0.0.1");
}

}  // namespace
}  // namespace coslam::doctor::network_test
