// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/settling.h"

#include <gtest/gtest.h>

namespace coslam::settling_test {
namespace {

using namespace std::chrono_literals;

class SettlingTest : public ::testing::Test {
 protected:
  const Instant start_{1h};
  WireConfig config_;
  Settling settling_{config_, RunId(3 * 1024 + 200), start_};  // announcements once a second
};

TEST_F(SettlingTest, AloneItSpeaksSoon) {
  EXPECT_FALSE(settling_.settle(true, start_ + 1199ms));
  EXPECT_FALSE(settling_.settled());
  EXPECT_TRUE(settling_.settle(true, start_ + 1200ms));
  EXPECT_TRUE(settling_.settled());
  EXPECT_FALSE(settling_.settle(true, start_ + 1300ms)) << "it has";
}

TEST_F(SettlingTest, BesideAnotherItListensLonger) {
  EXPECT_FALSE(settling_.settle(false, start_ + 5199ms));
  EXPECT_TRUE(settling_.settle(false, start_ + 5200ms)) << "200 ms of it by its run";
}

TEST_F(SettlingTest, YieldsToWhoWasThereBefore) {
  EXPECT_TRUE(settling_.yields_to_rival());
  EXPECT_FALSE(settling_.settle(true, start_ + 1h)) << "it ends";
}

TEST_F(SettlingTest, StaysWhenAnotherComesLater) {
  EXPECT_TRUE(settling_.settle(true, start_ + 2s));
  EXPECT_FALSE(settling_.yields_to_rival());
  EXPECT_TRUE(settling_.settled());
}

}  // namespace
}  // namespace coslam::settling_test
