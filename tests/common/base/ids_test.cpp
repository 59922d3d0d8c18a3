// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/ids.h"

#include <gtest/gtest.h>

#include <type_traits>
#include <unordered_set>

#include "common/base/check.h"
#include "common/base/time.h"

namespace coslam::ids_test {
namespace {

template <class A, class B>
concept Comparable = requires(A a, B b) {
  a == b;
};

TEST(Ids, KindsDoNotMix) {
  static_assert(!std::is_convertible_v<TrackId, PointId>);
  static_assert(!std::is_convertible_v<std::uint32_t, TrackId>);
  static_assert(!std::is_convertible_v<TrackId, std::uint32_t>);
  static_assert(!Comparable<SetId, FrameId>);
  static_assert(Comparable<SetId, SetId>);
}

TEST(Ids, ZeroIsTheDefaultAndOrderIsThatOfTheValue) {
  EXPECT_EQ(PointId(), PointId(0));
  EXPECT_LT(PointId(2), PointId(10));
  EXPECT_NE(RunId(1), RunId(2));
}

TEST(Ids, Hash) {
  const std::unordered_set<TrackId> set{TrackId(1), TrackId(2), TrackId(1)};
  EXPECT_EQ(set.size(), 2U);
  EXPECT_TRUE(set.contains(TrackId(2)));
}

TEST(Time, SecondsAndNanoseconds) {
  EXPECT_EQ(to_ns(0.5), 500'000'000);
  EXPECT_EQ(to_ns(-1e-9), -1);
  EXPECT_DOUBLE_EQ(to_seconds(1'500'000'000), 1.5);
  EXPECT_EQ(to_ns(to_seconds(123'456'789'012)), 123'456'789'012);
}

TEST(CheckDeathTest, SaysWhereAndWhy) {
  COSLAM_CHECK(1 + 1 == 2, "never seen");
  EXPECT_DEATH(COSLAM_CHECK(1 + 1 == 3, "arithmetic holds"), "ids_test.cpp:.*1 \\+ 1 == 3.*arithmetic holds");
}

}  // namespace
}  // namespace coslam::ids_test
