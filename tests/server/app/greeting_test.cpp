// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/greeting.h"

#include <gtest/gtest.h>

namespace coslam::greeting_test {
namespace {

TEST(Greeting, TellsWhereItIsAndHowToJoin) {
  WireConfig wire;
  wire.domain = 7;
  const Greeting open = greeting(wire, {"10.88.0.1", "10.99.0.1"}, "result");
  EXPECT_EQ(open.place, "DDS domain 7 at 10.88.0.1, 10.99.0.1, without a key; results go to result");
  EXPECT_EQ(open.agent, "coslam-agent --domain 7 --id NAME --source URI --calibration FILE");
  wire.key_file = "fleet.key";
  const Greeting sealed = greeting(wire, {"10.88.0.1"}, "");
  EXPECT_EQ(sealed.place, "DDS domain 7 at 10.88.0.1, with the fleet's key; results are not kept (--out DIR)");
  EXPECT_TRUE(sealed.agent.ends_with(" --set wire.key_file=fleet.key"));
}

TEST(Greeting, OnThisMachineAlone) {
  const Greeting alone = greeting(loopback_config(3), {"127.0.0.1"}, "result");
  EXPECT_TRUE(alone.agent.starts_with("coslam-agent --loopback --domain 3 ")) << alone.agent;
}

}  // namespace
}  // namespace coslam::greeting_test
