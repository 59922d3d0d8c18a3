// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What a participant answers to who asks with a plain socket, and announces to it.
#include "common/wire/echo.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "common/model/session.h"
#include "common/wire/announcement.h"
#include "common/wire/participant.h"
#include "common/wire/ports.h"
#include "tests/common/wire/plain_socket.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_domain.h"

namespace coslam::echo_test {
namespace {

using test::Octets;
using test::Socket;

template <class Value>
Octets octets_of(const Value& value) {
  const EchoOctets octets = encode(value);
  return {octets.begin(), octets.end()};
}

class Echo : public ::testing::Test {
 protected:
  std::uint16_t port(int participant) const {
    return static_cast<std::uint16_t>(unicast_port(domain_.number(), participant));
  }
  WireConfig with_key() const {
    WireConfig config = loopback_config(domain_.number());
    config.key_file = folder_.write("key", "the secret of this fleet").string();
    chmod(config.key_file.c_str(), 0600);
    return config;
  }

  const test::TestDomain domain_;
  const test::TempFolder folder_;
};

TEST_F(Echo, ComesBackToWhereItWasAsked) {
  const Participant participant(loopback_config(domain_.number()), "coslam-agent left");
  const Socket asks;
  for (const int at : {0, 1}) {  // where announcements arrive, and samples
    asks.send(octets_of(EchoRequest{.number = 17}), static_cast<std::uint16_t>(port(0) + at));
    const auto answer = decode_echo_answer(asks.receive());
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->number, 17U);
    EXPECT_EQ(answer->name, "coslam-agent left");
    EXPECT_EQ(answer->protocol, kProtocolVersion);
  }
}

TEST_F(Echo, OrToAnotherPort) {
  const Participant participant(loopback_config(domain_.number()), "coslam-server");
  const Socket asks, listens(port(20));
  asks.send(octets_of(EchoRequest{.number = 18, .answer_port = port(20)}), port(0));
  std::optional<EchoAnswer> answer;
  while (!answer) {  // announcements arrive there too
    const Octets heard = listens.receive();
    ASSERT_FALSE(heard.empty());
    answer = decode_echo_answer(heard);
  }
  EXPECT_EQ(answer->number, 18U);
}

TEST_F(Echo, IsSealedWhereThereIsAKey) {
  const WireConfig config = with_key();
  const Participant participant(config, "coslam-server");
  const Socket asks;
  const FleetKey key = load_fleet_key(config.key_file, config.domain);
  Sealer sealer(key);
  Opener opener(key);
  asks.send(octets_of(EchoRequest{.number = 1}), port(0));  // without the key: no answer
  Octets sealed;
  sealer.seal(octets_of(EchoRequest{.number = 2}), sealed);
  asks.send(sealed, port(0));
  const Octets answer = asks.receive();
  const auto read = decode_echo_answer(opener.open(answer).payload);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->number, 2U);
}

TEST_F(Echo, AnnouncementsTellWhoItIs) {
  const Socket listens(port(20));
  const Participant participant(loopback_config(domain_.number()), "coslam-agent left");
  std::optional<Announcement> heard;
  while (!heard) {
    const Octets octets = listens.receive();
    ASSERT_FALSE(octets.empty());
    heard = read_announcement(octets);
  }
  EXPECT_EQ(heard->name, "coslam-agent left");
  EXPECT_THAT(heard->endpoints, ::testing::Contains(Ipv4Endpoint{INADDR_LOOPBACK, port(0)}));
}

TEST(EchoOctets, SurviveTheWay) {
  const auto request = decode_echo_request(encode(EchoRequest{77, 9162}));
  ASSERT_TRUE(request);
  EXPECT_EQ(request->number, 77U);
  EXPECT_EQ(request->answer_port, 9162);
  const auto answer = decode_echo_answer(encode(EchoAnswer{78, -5, 14, std::string(200, 'n')}));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->answered_ns, -5);
  EXPECT_EQ(answer->name, std::string(95, 'n'));  // as much as there is room for
  EXPECT_FALSE(decode_echo_answer(encode(*request)));
  EXPECT_FALSE(decode_echo_request(Octets(kEchoBytes)));
  EXPECT_FALSE(decode_echo_request(Octets{'C', 'S', 'L', '?'}));
}

}  // namespace
}  // namespace coslam::echo_test
