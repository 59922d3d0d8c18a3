// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/metrics.h"

#include <gtest/gtest.h>

namespace coslam::metrics_test {
namespace {

TEST(DurationHistogram, EmptyIsZero) {
  const DurationHistogram h;
  EXPECT_EQ(h.count(), 0U);
  EXPECT_EQ(h.percentile_ms(50), 0);
  EXPECT_EQ(h.mean_ms(), 0);
  EXPECT_EQ(h.max_ms(), 0);
}

TEST(DurationHistogram, PercentilesAreExactToTheBinWidth) {
  DurationHistogram h;
  for (int i = 1; i <= 1000; ++i) h.add_ms(0.1 * i);
  EXPECT_EQ(h.count(), 1000U);
  EXPECT_NEAR(h.mean_ms(), 50.05, 1e-9);
  EXPECT_DOUBLE_EQ(h.max_ms(), 100);
  for (const double percent : {1.0, 10.0, 50.0, 95.0, 99.0}) {
    EXPECT_NEAR(h.percentile_ms(percent), percent, 0.04 * percent) << percent;
  }
  EXPECT_LE(h.percentile_ms(100), h.max_ms());
  EXPECT_GE(h.percentile_ms(100), 0.96 * h.max_ms());
}

TEST(DurationHistogram, OneValue) {
  DurationHistogram h;
  h.add_ms(8.25);
  for (const double percent : {0.0, 50.0, 100.0}) EXPECT_NEAR(h.percentile_ms(percent), 8.25, 0.04 * 8.25);
}

TEST(DurationHistogram, ValuesBeyondTheBinsAreKeptAtTheEnds) {
  DurationHistogram h;
  h.add_ms(0);
  h.add_ms(-1);
  h.add_ms(1e9);
  EXPECT_EQ(h.count(), 3U);
  EXPECT_DOUBLE_EQ(h.max_ms(), 1e9);
  EXPECT_LT(h.percentile_ms(10), 0.0011);
  EXPECT_DOUBLE_EQ(h.percentile_ms(100), 1e9);
}

TEST(StageTimes, MeasuresAScopeUnderItsName) {
  StageTimes times;
  for (int i = 0; i < 2; ++i) const auto scope = times.measure("track");
  { const auto scope = times.measure("pose"); }
  ASSERT_EQ(times.stages().size(), 2U);
  EXPECT_EQ(times.stages().at("track").count(), 2U);
  EXPECT_GE(times.stages().at("pose").max_ms(), 0);
}

TEST(PeakMemory, IsThatOfAProcess) {
  EXPECT_GT(peak_memory_mib(), 1);
  EXPECT_LT(peak_memory_mib(), 1e6);
}

}  // namespace
}  // namespace coslam::metrics_test
