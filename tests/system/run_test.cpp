// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// `coslam run` as a user meets it when all goes well.
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

#include "common/dataset/result.h"
#include "common/dataset/trajectory.h"
#include "tests/support/test_domain.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam {
namespace {

using test::Program;
using test::SmallScene;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class Run : public ::testing::Test {
 protected:
  std::vector<std::string> arguments(const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"run", scene_.sequence(), "--out", (scene_.folder() / out).string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  ResultFolder result(const std::string& out) const { return ResultFolder(scene_.folder() / out); }

  SmallScene scene_;
  test::TestDomain domain_;
};

TEST_F(Run, WritesTheResult) {
  Program run("coslam", arguments("result", {"--domain", std::to_string(domain_.number())}));
  ASSERT_EQ(run.exit_code(), 0) << run.err();
  const ResultFolder r = result("result");
  for (const auto& file : {r.map(), r.points(), r.dynamic(), r.groups(), r.report(), r.tracks("cam0"), r.live("cam1")})
    EXPECT_TRUE(std::filesystem::exists(file)) << file;
  for (const char* agent : {"cam0", "cam1"}) EXPECT_EQ(load_tum(r.trajectory(agent)).size(), 30U) << run.err();
  const auto report = read_json(r.report());
  EXPECT_EQ(report["frames"], 60);
  EXPECT_EQ(report["dropped"], 0);
  EXPECT_THAT(run.out(), ::testing::HasSubstr("result: " + r.path().string()));

  Program eval("coslam", {"eval", r.path().string(), scene_.sequence()});
  ASSERT_EQ(eval.exit_code(), 0) << eval.err();
  const auto evaluation = read_json(r.evaluation());
  EXPECT_LT(evaluation["ate_percent"].get<double>(), 5.0);
}

TEST_F(Run, ProcessesAndInlineAgree) {
  Program processes("coslam", arguments("processes", {"--domain", std::to_string(domain_.number())}));
  ASSERT_EQ(processes.exit_code(), 0) << processes.err();
  Program in_one("coslam", arguments("inline", {"--inline"}));
  ASSERT_EQ(in_one.exit_code(), 0) << in_one.err();
  const auto configured = read_json(result("processes").report())["configuration"]["server"];
  EXPECT_EQ(configured["baseline_m"], SmallScene::kBaseline_m);
  EXPECT_EQ(configured, read_json(result("inline").report())["configuration"]["server"]);
  for (const char* agent : {"cam0", "cam1"}) {
    EXPECT_EQ(load_tum(result("processes").trajectory(agent)).size(), 30U);
    EXPECT_EQ(text_of(result("processes").trajectory(agent)), text_of(result("inline").trajectory(agent)));
  }
  EXPECT_EQ(text_of(result("processes").points()), text_of(result("inline").points()));
}

}  // namespace
}  // namespace coslam
