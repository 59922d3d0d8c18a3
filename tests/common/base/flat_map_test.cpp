// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/flat_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace coslam::flat_map_test {
namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(FlatMapTest, KeepsItsOrderAndLosesWhatIsErased) {
  FlatMap<int, std::string> map;
  for (const int key : {5, 1, 9, 3, 7}) map[key] = std::to_string(key);
  EXPECT_THAT(map, ElementsAre(Pair(1, "1"), Pair(3, "3"), Pair(5, "5"), Pair(7, "7"), Pair(9, "9")));
  erase_if(&map, [](const auto& entry) { return entry.first % 3 == 0; });
  EXPECT_THAT(map, ElementsAre(Pair(1, "1"), Pair(5, "5"), Pair(7, "7")));
  map[2] = "new";
  EXPECT_EQ(map.at(2), "new");
  EXPECT_FALSE(map.contains(9));
}

}  // namespace
}  // namespace coslam::flat_map_test
