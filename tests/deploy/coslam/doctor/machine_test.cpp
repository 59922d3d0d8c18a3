// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/machine.h"

#include "tests/deploy/coslam/doctor/said.h"
#include "tests/support/temp_folder.h"

namespace coslam::doctor::machine_test {
namespace {

constexpr std::uint64_t kMebibyte = 1U << 20U;

TEST(DoctorMachine, Processor) {
  EXPECT_THAT(first_of(judge(ProcessorFacts{.cores = 4, .load = 1.25})), Says(Grade::kOk, "4 cores, load 1.3", ""));
  EXPECT_THAT(first_of(judge(ProcessorFacts{.cores = 2, .load = 5})), Says(Grade::kWarn, "other work", "top"));
  EXPECT_THAT(first_of(judge(ProcessorFacts{.cores = 2, .governor = "powersave"})),
              Says(Grade::kWarn, "'powersave'", "cpupower"));
  EXPECT_THAT(judge(ProcessorFacts{.gpu = true}).back(), Says(Grade::kOk, "a driver offers one", ""));
}

TEST(DoctorMachine, Environment) {
  const Findings said = judge(EnvironmentFacts{{"FASTDDS_STATISTICS"}, 3, 3, "CoSLAM 1"});
  ASSERT_EQ(said.size(), 3U);
  EXPECT_THAT(said[0], Says(Grade::kOk, "CoSLAM 1", ""));
  EXPECT_THAT(said[1], Says(Grade::kOk, "FASTDDS_STATISTICS is set", ""));
  EXPECT_THAT(said[2], Says(Grade::kWarn, "ROS_DOMAIN_ID is 3", "--domain"));
  EXPECT_EQ(judge(EnvironmentFacts{{}, 4, 3, "CoSLAM 1"}).size(), 1U);
}

TEST(DoctorMachine, SharedMemory) {
  SharedMemoryFacts facts{.exists = true, .writable = true, .free_bytes = 500 * kMebibyte};
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kOk, "500 MiB free", ""));
  facts.segments = 5;
  facts.stale = 3;
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kOk, "3 of 5 segments", "fastdds shm clean"));
  facts.stale = 50;
  EXPECT_EQ(first_of(judge(facts)).grade, Grade::kWarn);
  facts = {.exists = true, .writable = true, .free_bytes = kMebibyte};
  EXPECT_THAT(first_of(judge(facts)), Says(Grade::kWarn, "1 MiB", "ls"));
  EXPECT_THAT(first_of(judge(SharedMemoryFacts{.exists = true})),
              Says(Grade::kWarn, "cannot be written", "chmod 1777"));
  EXPECT_THAT(first_of(judge(SharedMemoryFacts{})), Says(Grade::kWarn, "is not there", "mount"));
}

TEST(DoctorMachine, SharedMemoryOfThisTest) {
  const test::TempFolder folder;
  folder.write("fastrtps_0123_el", "");  // nobody holds its lock
  folder.write("fastrtps_0123", "");
  folder.write("fastdds_4567_el", "");
  const SharedMemoryFacts facts = look_at_shared_memory(folder.path().string());
  EXPECT_TRUE(facts.exists);
  EXPECT_TRUE(facts.writable);
  EXPECT_EQ(facts.segments, 2);
  EXPECT_EQ(facts.stale, 2);
  EXPECT_FALSE(look_at_shared_memory((folder / "none").string()).exists);
}

TEST(DoctorMachine, Buffers) {
  EXPECT_THAT(first_of(judge(BufferFacts{212992, 212992, 4194304, 100})),
              Says(Grade::kWarn, "rmem_max is 212992", "sudo sysctl -w net.core.rmem_max=4194304"));
  EXPECT_EQ(first_of(judge(BufferFacts{4194304, 4194304, 4194304, 100})).grade, Grade::kOk);
  EXPECT_EQ(first_of(judge(BufferFacts{0, 0, 4194304, 100})).grade, Grade::kOk);  // as within a container
}

TEST(DoctorMachine, Disk) {
  EXPECT_THAT(first_of(judge(DiskFacts{"result", "", 5000 * kMebibyte})), Says(Grade::kOk, "5000 MiB free", ""));
  EXPECT_THAT(first_of(judge(DiskFacts{"result", "", 500 * kMebibyte})), Says(Grade::kWarn, "500 MiB", "--out"));
  EXPECT_THAT(first_of(judge(DiskFacts{"result", "", 5 * kMebibyte})), Says(Grade::kFail, "it is full", "--out"));
  EXPECT_THAT(first_of(judge(DiskFacts{"result", "Read-only file system", 5000 * kMebibyte})),
              Says(Grade::kFail, "result: Read-only file system", "--out"));
}

TEST(DoctorMachine, DiskOfThisTest) {
  const test::TempFolder folder;
  const DiskFacts facts = look_at_disk((folder / "not/there/yet").string());
  EXPECT_EQ(facts.problem, "");
  EXPECT_GT(facts.free_bytes, 0U);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_NE(look_at_disk("/proc/nowhere").problem, "");
}

}  // namespace
}  // namespace coslam::doctor::machine_test
