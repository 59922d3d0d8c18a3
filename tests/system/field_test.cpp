// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Hosts of their own, with links that lose and reorder and a clock that is wrong: the short form of
// deploy/test-field.sh. What faults cost is told against the run without one, which is as fast as the machine is.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam::field_test {
namespace {

constexpr int kSkipped = 77;

// The columns of the row of a fault in a table in Markdown.
std::vector<std::string> columns_of(const std::string& table, const std::string& fault) {
  const auto rows = test::lines_with(table, "| " + fault + " |");
  EXPECT_EQ(rows.size(), 1U) << table;
  std::vector<std::string> out;
  std::istringstream stream(rows.empty() ? "" : rows[0]);
  for (std::string column; std::getline(stream, column, '|');) {
    const auto first = column.find_first_not_of(' '), last = column.find_last_not_of(' ');
    out.push_back(first == std::string::npos ? "" : column.substr(first, last - first + 1));
  }
  return out;
}

double percent_tracked(const std::string& table, const std::string& fault) {
  return std::stod(columns_of(table, fault).at(4));
}

TEST(Field, LossReorderAndAWrongClockLoseNobody) {
  // Long beside the three seconds that a map may take to begin where a tenth of what it needs is lost at each try.
  const test::SmallScene scene(2, 360);
  const std::string table = (scene.folder() / "table.txt").string();
  const std::string command = "python3 " COSLAM_SOURCE "/tests/field/field.py --bin " COSLAM_BIN " --sequence " +
                              scene.sequence() + " --out " + (scene.folder() / "field").string() +
                              " --only 'loss 10 %' --only 'delay 200 +- 100 ms' --only 'clock +5s' > " + table +
                              " 2>&1";
  const int code = WEXITSTATUS(std::system(command.c_str()));
  std::ifstream stream(table);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (code == kSkipped) GTEST_SKIP() << text;
  ASSERT_EQ(code, 0) << text;
  const double whole = percent_tracked(text, "none");
  for (const std::string fault : {"loss 10 %", "delay 200 +- 100 ms", "clock +5s"}) {
    EXPECT_GT(percent_tracked(text, fault), 0.65 * whole) << fault << "\n" << text;
    EXPECT_EQ(columns_of(text, fault).at(5), "1") << "maps\n" << text;
  }
}

}  // namespace
}  // namespace coslam::field_test
