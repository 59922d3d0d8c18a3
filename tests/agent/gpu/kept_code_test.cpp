// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/kept_code.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temp_folder.h"

namespace coslam::kept_code_test {
namespace {

namespace fs = std::filesystem;

const std::vector<char> kCode{'a', '\0', '\n', 'e', 'n', 'd', 'b'};

TEST(KeptCode, IsThereAtTheNextStart) {
  const test::TempFolder folder;
  EXPECT_FALSE(KeptCode(folder.path() / "gpu").find("key\nof two lines"));
  KeptCode(folder.path() / "gpu").keep("key\nof two lines", kCode);
  EXPECT_EQ(KeptCode(folder.path() / "gpu").find("key\nof two lines"), kCode);
  EXPECT_FALSE(KeptCode(folder.path() / "gpu").find("key"));
}

TEST(KeptCode, TheNewestStays) {
  const test::TempFolder folder;
  const KeptCode kept(folder.path());
  kept.keep("key", kCode);
  kept.keep("key", {'c'});
  EXPECT_EQ(kept.find("key"), std::vector<char>{'c'});
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(KeptCode, WhatIsNotWholeIsNotThere) {
  const test::TempFolder folder;
  const KeptCode kept(folder.path());
  kept.keep("key", kCode);
  const fs::path file = fs::directory_iterator(folder.path())->path();
  for (auto bytes = fs::file_size(file); bytes-- > 0;) {
    fs::resize_file(file, bytes);
    EXPECT_FALSE(kept.find("key")) << bytes;
  }
  std::ofstream(file) << "key\n4000000000\nendend";
  EXPECT_FALSE(kept.find("key"));
}

TEST(KeptCode, AFolderThatCannotBeWrittenKeepsNothing) {
  const test::TempFolder folder;
  std::ofstream(folder.path() / "file") << "no folder";
  const KeptCode kept(folder.path() / "file");
  kept.keep("key", kCode);
  EXPECT_FALSE(kept.find("key"));
  const KeptCode none{fs::path()};
  none.keep("key", kCode);
  EXPECT_FALSE(none.find("key"));
}

}  // namespace
}  // namespace coslam::kept_code_test
