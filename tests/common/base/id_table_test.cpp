// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/id_table.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "common/base/ids.h"

namespace coslam::id_table_test {
namespace {

TEST(IdTable, FindsWhatAMapFinds) {
  IdTable<PointId, int> table;
  std::map<PointId, int> all;
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const PointId id(random() % 3000);
    if (random() % 2 == 0) {
      int& value = all[id] = i;
      table.put(id, value);
    } else {
      all.erase(id);
      table.erase(id);
    }
  }
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const auto at = all.find(PointId(i));
    EXPECT_EQ(table.find(PointId(i)), at == all.end() ? nullptr : &at->second) << i;
  }
}

TEST(IdTable, WhatIsGoneTakesLittle) {
  IdTable<PointId, int> table;
  int value = 1;
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    table.put(PointId(i), value);
    if (i >= 1000) table.erase(PointId(i - 1000));
  }
  EXPECT_LT(table.bytes(), 40'000U);
}

}  // namespace
}  // namespace coslam::id_table_test
