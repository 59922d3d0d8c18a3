// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/spill_file.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <random>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::spill_file_test {
namespace {

using ::testing::HasSubstr;

// Files of this process end after so many octets, as on a full disk.
class FileLimit {
 public:
  explicit FileLimit(rlim_t octets) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{octets, before_.rlim_max};
    EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  }
  ~FileLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, SIG_DFL);
  }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
};

TEST(SpillFile, GivesBackWhatWasPutThere) {
  const test::TempFolder folder;
  SpillFile file(folder.path());
  std::mt19937 random(5);
  std::vector<std::string> all;
  std::vector<SpillFile::Ticket> tickets;
  for (int i = 0; i < 50; ++i) {
    std::string octets(random() % 5000, '\0');
    for (char& c : octets) c = static_cast<char>(random());
    tickets.push_back(file.put(octets));
    all.push_back(octets);
  }
  for (std::size_t i = all.size(); i-- > 0;) EXPECT_EQ(file.get(tickets[i]), all[i]) << i;
  EXPECT_EQ(file.get(tickets[7]), all[7]) << "as often as one likes";
  EXPECT_EQ(file.get(file.put("")), "");
  EXPECT_FALSE(file.take_problem());
}

TEST(SpillFile, HasNoNameInItsFolder) {
  const test::TempFolder folder;
  SpillFile file(folder.path());
  file.put(std::string(10'000, 'x'));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(SpillFile, WithoutAFolderAllStaysInMemory) {
  const test::TempFolder folder;
  SpillFile file(folder / "later");
  const SpillFile::Ticket first = file.put("first"), second = file.put("second");
  EXPECT_EQ(file.get(first), "first");
  EXPECT_EQ(file.get(second), "second");
  const auto problem = file.take_problem();
  ASSERT_TRUE(problem);
  EXPECT_THAT(*problem, HasSubstr((folder / "later").string() + ": No such file or directory; mapping goes on"));
  EXPECT_FALSE(file.take_problem()) << "it is told once";
  file.put("third");
  EXPECT_FALSE(file.take_problem()) << "nothing has changed";

  std::filesystem::create_directory(folder / "later");
  const SpillFile::Ticket fourth = file.put("fourth");
  EXPECT_EQ(file.get(first), "first");
  EXPECT_EQ(file.get(fourth), "fourth");
  EXPECT_FALSE(file.take_problem());
}

TEST(SpillFile, OnAFullDiskNothingIsLostAndWritingGoesOnLater) {
  const test::TempFolder folder;
  SpillFile file(folder.path());
  const std::string large(3000, 'a'), larger(6000, 'b');
  const SpillFile::Ticket first = file.put(large);
  SpillFile::Ticket second = 0, third = 0;
  std::optional<std::string> problem;
  {
    const FileLimit limit(5000);
    second = file.put(larger);
    problem = file.take_problem();
    third = file.put("brief");
    EXPECT_FALSE(file.take_problem()) << "the disk is as full as before";
    EXPECT_EQ(file.get(first), large);
    EXPECT_EQ(file.get(second), larger);
  }
  ASSERT_TRUE(problem);
  EXPECT_THAT(*problem, HasSubstr("cannot be put to disk in " + folder.path().string()));
  const SpillFile::Ticket fourth = file.put("after");
  EXPECT_EQ(file.get(first), large);
  EXPECT_EQ(file.get(second), larger) << "what was half written is written once more";
  EXPECT_EQ(file.get(third), "brief");
  EXPECT_EQ(file.get(fourth), "after");
  {
    const FileLimit limit(1);
    file.put("again");
    EXPECT_TRUE(file.take_problem()) << "writing failed anew";
  }
}

}  // namespace
}  // namespace coslam::spill_file_test
