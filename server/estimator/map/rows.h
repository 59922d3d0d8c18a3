// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace coslam {

// Row of a map file: octets by table and number.
struct Row {
  std::string table;
  std::int64_t key = 0;
  std::string bytes;  // empty: this row was removed
};
using Tables = std::map<std::string, std::map<std::int64_t, std::string>>;

// Version of the octets in rows. 1 has no past; 2 lacks what fields() of the entities has since 3.
inline constexpr int kRowsVersion = 3;

// Keys of the table "state", one for each object that keeps something beside the map.
enum class StateRow : std::int64_t {
  kMap,
  kMeetings,
  kScale,
  kObjects,
  kPast,
  kAdjusted,
  kRun,
  kSpared,
  kLenses
};  // kLenses: in files before version 3

}  // namespace coslam
