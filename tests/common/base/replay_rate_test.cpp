// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/replay_rate.h"

#include <gtest/gtest.h>

#include "common/base/error.h"

namespace coslam::replay_rate_test {
namespace {

TEST(ReplayRate, IsAFactorOrMax) {
  EXPECT_EQ(parse_replay_rate("max"), 0);
  EXPECT_EQ(parse_replay_rate("1"), 1);
  EXPECT_EQ(parse_replay_rate("0.25"), 0.25);
  EXPECT_EQ(parse_replay_rate("1000"), 1000);
}

TEST(ReplayRate, NothingElse) {
  for (const char* text : {"", "fast", "0", "-1", "1001", "2x", "inf", "nan", "Max"}) {
    EXPECT_THROW(parse_replay_rate(text), UsageError) << text;
  }
}

}  // namespace
}  // namespace coslam::replay_rate_test
