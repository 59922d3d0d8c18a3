// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <thread>

#include "common/base/version.h"
#include "common/wire/participant.h"
#include "deploy/coslam/doctor/machine.h"
#include "tests/support/temp_folder.h"

namespace coslam::doctor::machine_facts_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A variable of the environment while the object lives.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    value == nullptr ? unsetenv(name) : setenv(name, value, 1);
  }
  ~Variable() { before_ ? setenv(name_, before_->c_str(), 1) : unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

std::uint64_t number_in(const std::string& file) {
  std::uint64_t number = 0;
  std::ifstream(file) >> number;
  return number;
}

TEST(MachineFacts, ThisProcessorHasCoresAndALoad) {
  const ProcessorFacts facts = look_at_processor();
  EXPECT_EQ(facts.cores, static_cast<int>(std::thread::hardware_concurrency()));
  EXPECT_GE(facts.load, 0);
  EXPECT_LT(facts.load, 10'000);
}

TEST(MachineFacts, TheDomainOfRosIsOneIfItIsANumber) {
  {
    const Variable domain("ROS_DOMAIN_ID", "42");
    EXPECT_EQ(look_at_environment(3).ros_domain, 42);
    EXPECT_EQ(look_at_environment(3).domain, 3);
  }
  for (const char* text : {static_cast<const char*>(nullptr), "", "forty", "4.5"}) {
    const Variable domain("ROS_DOMAIN_ID", text);
    EXPECT_FALSE(look_at_environment(3).ros_domain) << (text == nullptr ? "not set" : text);
  }
}

TEST(MachineFacts, VariablesThatSteerTheMiddlewareAreNoticed) {
  for (const char* name : kIgnoredVariables) {
    const Variable unset(name, nullptr);
    EXPECT_THAT(look_at_environment(0).ignored, ::testing::Not(Contains(name)));
    const Variable set(name, "");
    EXPECT_THAT(look_at_environment(0).ignored, Contains(name)) << "even an empty one";
  }
}

TEST(MachineFacts, VersionsAreThoseOfProductAndLibraries) {
  const std::string versions = look_at_environment(0).versions;
  EXPECT_THAT(versions, HasSubstr(std::string("CoSLAM ") + version()));
  EXPECT_THAT(versions, HasSubstr("Fast DDS " + std::string(middleware_version())));
  EXPECT_THAT(versions, HasSubstr("OpenCV "));
}

TEST(MachineFacts, BuffersAreThoseOfTheKernel) {
  const BufferFacts facts = look_at_buffers(7, 8);
  EXPECT_EQ(facts.most_receive, number_in("/proc/sys/net/core/rmem_max"));
  EXPECT_EQ(facts.most_send, number_in("/proc/sys/net/core/wmem_max"));
  EXPECT_EQ(facts.wanted_receive, 7U);
  EXPECT_EQ(facts.wanted_send, 8U);
}

TEST(MachineFacts, ASegmentWhoseLockIsHeldIsNotStale) {
  const test::TempFolder folder;
  const std::string held = folder.write("fastrtps_held_el", "").string();
  folder.write("fastrtps_left_el", "");
  folder.write("another_el", "");
  const int file = open(held.c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(flock(file, LOCK_EX | LOCK_NB), 0);
  SharedMemoryFacts facts = look_at_shared_memory(folder.path().string());
  EXPECT_EQ(facts.segments, 2);
  EXPECT_EQ(facts.stale, 1);
  EXPECT_GT(facts.free_bytes, 0U);
  close(file);
  facts = look_at_shared_memory(folder.path().string());
  EXPECT_EQ(facts.stale, 2) << "its process has ended";
  EXPECT_FALSE(look_at_shared_memory(held).exists) << "a file is no folder";
}

TEST(MachineFacts, AFolderBelowAFileCannotBeWritten) {
  const test::TempFolder folder;
  const std::string inside = (folder.write("file", "") / "result").string();
  const DiskFacts facts = look_at_disk(inside);
  EXPECT_EQ(facts.folder, inside);
  EXPECT_EQ(facts.problem, "Not a directory");
  EXPECT_THAT(look_at_disk(folder.path().string()).problem, IsEmpty());
}

TEST(MachineFacts, ARelativeFolderIsWhereTheProgramRuns) {
  const std::filesystem::path here = std::filesystem::current_path();
  const test::TempFolder folder;
  std::filesystem::current_path(folder.path());
  const DiskFacts facts = look_at_disk("result/of/today");
  std::filesystem::current_path(here);
  EXPECT_EQ(facts.problem, "");
  EXPECT_EQ(facts.folder, "result/of/today");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "nothing is left behind";
}

}  // namespace
}  // namespace coslam::doctor::machine_facts_test
