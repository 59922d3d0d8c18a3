// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/peer_names.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "common/base/log.h"

namespace coslam::peer_names_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(PeerNames, AreKnownWhereTheSystemHasAnAddress) {
  EXPECT_THAT(unknown_peers({"127.0.0.1", "localhost", "server.invalid"}), ElementsAre("server.invalid"));
  EXPECT_THROW(unknown_peers({"192.168.1"}), UserError);
}

TEST(PeerNames, AreWaitedFor) {
  std::vector<std::string> peers{"base.local", "10.0.0.2"};
  int waits = 0;
  await_names(
      &peers, [&] { return ++waits < 10; },
      [&](const auto&) { return waits < 3 ? std::vector<std::string>{"base.local"} : std::vector<std::string>(); });
  EXPECT_EQ(waits, 3);
  EXPECT_THAT(peers, ElementsAre("base.local", "10.0.0.2"));
}

TEST(PeerNames, ThatStayUnknownAreLeftOutWithAWarning) {
  std::vector<std::string> peers{"base.local", "10.0.0.2"};
  int waits = 0;
  await_names(
      &peers, [&] { return ++waits < 5; }, [](const auto&) { return std::vector<std::string>{"base.local"}; });
  EXPECT_EQ(waits, 5);
  EXPECT_THAT(peers, ElementsAre("10.0.0.2"));
  EXPECT_THAT(warnings_given().back().text, HasSubstr("no address is known of the peer base.local: going on without"));
}

TEST(PeerNames, ThatAreKnownAreNotWaitedFor) {
  std::vector<std::string> peers;
  await_names(
      &peers, [] { return ADD_FAILURE() << "waits", false; }, [](const auto&) { return std::vector<std::string>(); });
  EXPECT_THAT(peers, IsEmpty());
}

}  // namespace
}  // namespace coslam::peer_names_test
