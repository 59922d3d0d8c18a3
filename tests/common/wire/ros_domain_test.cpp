// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/ros_domain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::ros_domain_test {
namespace {

TEST(RosDomain, IsThatOfTheVariable) {
  unsetenv("ROS_DOMAIN_ID");
  EXPECT_EQ(ros_domain_id(), std::nullopt);
  setenv("ROS_DOMAIN_ID", "", 1);
  EXPECT_EQ(ros_domain_id(), std::nullopt);
  setenv("ROS_DOMAIN_ID", "42", 1);
  EXPECT_EQ(ros_domain_id(), 42);
  for (const char* wrong : {"233", "-1", "one", "1 "}) {
    setenv("ROS_DOMAIN_ID", wrong, 1);
    EXPECT_THAT(test::error_of<UserError>([] { ros_domain_id(); }), testing::HasSubstr("is no DDS domain (0 to 232)"));
  }
  unsetenv("ROS_DOMAIN_ID");
}

TEST(RosDomain, IsJoinedOnTheLoopbackUnlessToldOtherwise) {
  const WireConfig here = ros_wire(3);
  EXPECT_EQ(here.interfaces, std::vector<std::string>{"127.0.0.1"});
  EXPECT_EQ(here.peers, std::vector<std::string>{"127.0.0.1"});
  EXPECT_EQ(here.domain, 3);
  const WireConfig all = ros_wire(3, {});
  EXPECT_TRUE(all.interfaces.empty() && all.peers.empty());
}

}  // namespace
}  // namespace coslam::ros_domain_test
