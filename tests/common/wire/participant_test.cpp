// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/participant.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "common/base/error.h"
#include "tests/support/all_ports.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_domain.h"

namespace coslam::participant_test {
namespace {

using test::TestDomain;
using testing::HasSubstr;
using testing::Not;

std::string error_of(const WireConfig& config) {
  try {
    const Participant participant(config, "test");
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

TEST(Participant, DomainOutsideTheRangeIsAUserError) {
  EXPECT_THAT(error_of(loopback_config(233)), HasSubstr("DDS domain 233 is outside the range 0 to 232"));
  EXPECT_THAT(error_of(loopback_config(-1)), HasSubstr("DDS domain -1 is outside the range 0 to 232"));
}

TEST(Participant, VariablesForRosNodesAreNotObeyed) {
  const TestDomain domain;
  setenv("ROS_DISCOVERY_SERVER", "203.0.113.9:11811", 1);
  EXPECT_EQ(error_of(loopback_config(domain.number())), "no error");
  EXPECT_EQ(std::getenv("ROS_DISCOVERY_SERVER"), nullptr);
}

TEST(Participant, LargestDomainWorks) { EXPECT_EQ(error_of(loopback_config(232)), "no error"); }

TEST(Participant, UnknownInterfaceIsNamedBesideTheKnownOnes) {
  WireConfig config = loopback_config(10);
  config.interfaces = {"203.0.113.9"};
  EXPECT_THAT(error_of(config), HasSubstr("'203.0.113.9' is not an IPv4 address of this machine (it has 127.0.0.1"));
}

TEST(Participant, PeersMustBeAddresses) {
  WireConfig config = loopback_config(10);
  config.peers = {"server.invalid"};
  EXPECT_THAT(error_of(config), HasSubstr("peer 'server.invalid' is no IPv4 address and no name of one"));
  config.peers = {"::1"};
  EXPECT_THAT(error_of(config), HasSubstr("peer '::1' is an IPv6 address: the fleet speaks IPv4"));
  for (const char* part : {"192.168.1", "0x7f000001", "2130706433"}) {
    config.peers = {part};
    EXPECT_THAT(error_of(config), HasSubstr("'" + std::string(part) + "' is no whole IPv4 address"));
  }
  for (const char* of_many : {"0.0.0.0", "255.255.255.255", "239.255.0.1"}) {
    config.peers = {of_many};
    EXPECT_THAT(error_of(config), HasSubstr("'" + std::string(of_many) + "' is the address of no single machine"));
  }
  for (const char* more : {"10.0.0.2:7400", "http://server", "10.0.0.0/24"}) {
    config.peers = {more};
    EXPECT_THAT(error_of(config), HasSubstr("'" + std::string(more) + "' is more than a name or an IPv4 address"));
  }
  config.peers = {"localhost"};
  EXPECT_EQ(error_of(config), "no error");
}

TEST(Participant, TakenPortsAreAUserErrorNotSilence) {
  const TestDomain domain;
  const test::AllPorts taken(domain.number());
  EXPECT_THAT(error_of(loopback_config(domain.number())),
              HasSubstr("no UDP port is free for DDS domain " + std::to_string(domain.number())));
}

TEST(Participant, MissingCertificateIsNamed) {
  WireConfig config = loopback_config(10);
  config.certificates = "/nowhere";
  EXPECT_THAT(error_of(config), HasSubstr("certificate file '/nowhere/ca.pem' is missing"));
}

TEST(Participant, KeyFileMustBeFit) {
  WireConfig config = loopback_config(10);
  config.key_file = "/nowhere/fleet.key";
  EXPECT_EQ(error_of(config), "key file '/nowhere/fleet.key' cannot be opened: No such file or directory");
}

TEST(Participant, WarnsOnceWhenItIsOpenToTheNetwork) {
  const TestDomain domain;
  const test::TempFolder folder;
  const auto log_of = [](const WireConfig& config) {
    testing::internal::CaptureStdout();
    EXPECT_EQ(error_of(config), "no error");
    return testing::internal::GetCapturedStdout();
  };
  const std::string warning = "whoever can send datagrams to DDS domain " + std::to_string(domain.number());
  WireConfig config = loopback_config(domain.number());
  EXPECT_THAT(log_of(config), Not(HasSubstr(warning)));
  config.interfaces.clear();
  const std::string log = log_of(config);
  EXPECT_THAT(log, HasSubstr(warning));
  EXPECT_EQ(log.find(warning), log.rfind(warning));
  config.key_file = folder.write("fleet.key", "the secret of this fleet").string();
  std::filesystem::permissions(config.key_file, std::filesystem::perms::owner_read);
  EXPECT_THAT(log_of(config), Not(HasSubstr(warning)));
}

TEST(LinkBytes, CountsTheHeadersOfEveryDatagram) {
  EXPECT_EQ(link_bytes(100, 1400), 260u);
  EXPECT_EQ(link_bytes(1224, 1400), 1384u) << "one full datagram";
  EXPECT_EQ(link_bytes(1225, 1400), 1225u + 2 * 172);
  EXPECT_EQ(link_bytes(1751, 1400), 1751u + 2 * 172) << "a frame of 300 tracks";
  EXPECT_EQ(link_bytes(1751, 65000), 1911u);
}

TEST(LinkBytes, CountsTheSealsWhereThereIsAKey) {
  EXPECT_EQ(link_bytes(100, 1400, true), 292u);
  EXPECT_EQ(link_bytes(1192, 1400, true), 1384u) << "one full datagram";
  EXPECT_EQ(link_bytes(1193, 1400, true), 1193u + 2 * 204);
}

}  // namespace
}  // namespace coslam::participant_test
