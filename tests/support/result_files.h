// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

namespace coslam::test {

// Name and content of all files of a result but the report, which has times in it.
inline std::map<std::string, std::string> result_files(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.path().filename() == "report.json") continue;
    std::ifstream stream(entry.path(), std::ios::binary);
    files[entry.path().lexically_relative(folder).string()] = {std::istreambuf_iterator<char>(stream), {}};
  }
  return files;
}

// To the bit.
inline void expect_same_result(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto files_a = result_files(a), files_b = result_files(b);
  EXPECT_GE(files_a.size(), 11U) << a;
  EXPECT_EQ(files_a.size(), files_b.size());
  for (const auto& [name, content] : files_a) {
    ASSERT_TRUE(files_b.contains(name)) << name;
    EXPECT_TRUE(content == files_b.at(name)) << name;
  }
}

}  // namespace coslam::test
