// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// `coslam status` beside running programs.
#include <gmock/gmock.h>

#include <csignal>
#include <iterator>
#include <sstream>

#include "tests/support/test_domain.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam::status_test {
namespace {

using test::lines_with;
using test::Program;
using test::SmallScene;
using ::testing::HasSubstr;
using ::testing::SizeIs;

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

TEST(Status, TellsWhoIsAlive) {
  const SmallScene scene(2, 900);  // half a minute in real time
  const test::TestDomain domain;
  const std::string number = std::to_string(domain.number());
  Program server("coslam-server", {"--loopback", "--domain", number});
  const auto agent = [&](int camera) { return scene.agent(camera, number, "1"); };
  Program a("coslam-agent", agent(0)), b("coslam-agent", agent(1));
  for (const int camera : {0, 1}) ASSERT_TRUE(server.says("agent " + scene.name(camera) + " joined")) << server.err();
  ASSERT_TRUE(server.says("frame set")) << server.err();
  Program status("coslam", {"status", "--loopback", "--domain", number});
  ASSERT_EQ(status.exit_code(), 0) << status.err();
  EXPECT_THAT(lines_with(status.out(), "map server"), SizeIs(1)) << status.out();
  EXPECT_THAT(status.out(), HasSubstr(": running, "));
  for (const int camera : {0, 1}) {
    const auto lines = lines_with(status.out(), scene.name(camera) + " ");
    ASSERT_THAT(lines, SizeIs(1)) << status.out();
    const auto words = words_of(lines.front());
    ASSERT_THAT(words, SizeIs(12)) << status.out();
    EXPECT_EQ(words[1], "running");
    EXPECT_EQ(words[2], "tracked") << status.out();
    EXPECT_EQ(words[3], "1") << "group: " << status.out();
    EXPECT_GT(std::stod(words[6]), 20) << "tracks: " << status.out();
    EXPECT_GT(std::stod(words[8]), 5) << "Hz: " << status.out();  // 30 on a machine with time
    EXPECT_LT(std::stod(words[8]), 60) << "Hz: " << status.out();
    EXPECT_LT(std::stod(words[9]), 500) << "lag: " << status.out();
    EXPECT_GT(std::stod(words[10]), 1) << "up: " << status.out();
    EXPECT_GT(std::stod(words[11]), 1) << "down: " << status.out();
  }
  Program watch("coslam", {"status", "--loopback", "--domain", number, "--watch", "--json"});
  EXPECT_TRUE(watch.prints("\n{\"servers\":[{\"run\":\"")) << watch.out() << watch.err();  // the second time
  watch.signal(SIGINT);
  for (Program* program : {&a, &b, &server}) {
    program->signal(SIGINT);
    EXPECT_EQ(program->exit_code(), 0) << program->err();
  }
}

TEST(Status, SaysSoWhenNobodyIsHeard) {
  const test::TestDomain domain;
  Program status("coslam", {"status", "--loopback", "--domain", std::to_string(domain.number())});
  EXPECT_EQ(status.exit_code(), 1);
  EXPECT_THAT(status.err(), HasSubstr("coslam: nobody was heard in DDS domain " + std::to_string(domain.number())));
}

}  // namespace
}  // namespace coslam::status_test
