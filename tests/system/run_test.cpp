// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// `coslam run` as a user meets it when all goes well.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "common/dataset/result.h"
#include "common/dataset/trajectory.h"
#include "tests/support/test_domain.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam::run_test {
namespace {

using test::Program;
using test::SmallScene;

// Relative to the folder.
std::set<std::string> files_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.insert(entry.path().lexically_relative(folder).string());
  }
  return names;
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
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
  EXPECT_THAT(run.err(), ::testing::HasSubstr(" of 30)")) << "frames of the longest source";

  Program eval("coslam", {"eval", r.path().string(), scene_.sequence()});
  ASSERT_EQ(eval.exit_code(), 0) << eval.err();
  const auto evaluation = read_json(r.evaluation());
  // 0.07 to 0.25, with a scale of 1.004 to 1.010, over ten textures of the scene.
  EXPECT_LT(evaluation["ate_percent"].get<double>(), 0.75);
  EXPECT_NEAR(evaluation["scale"].get<double>(), 1, 0.03);
  for (const char* agent : {"cam0", "cam1"}) EXPECT_EQ(evaluation["agents"][agent]["tracked_percent"], 100.0) << agent;
}

// No sequence file and no calibrations: what is there to be seen.
TEST_F(Run, MapsSourcesOfWhichNothingIsKnown) {
  const std::string out = (scene_.folder() / "result").string();
  Program run("coslam", {"run", scene_.source(0), scene_.source(1), "--inline", "--out", out});
  ASSERT_EQ(run.exit_code(), 0) << run.err();
  EXPECT_THAT(run.err(), ::testing::HasSubstr("agent cam1: no calibration is given"));
  const ResultFolder r = result("result");
  for (const char* agent : {"cam0", "cam1"}) EXPECT_FALSE(load_tum(r.trajectory(agent)).empty()) << agent;
  Program mixed("coslam", {"run", scene_.source(0), scene_.sequence(), "--inline", "--out", out + "2"});
  EXPECT_EQ(mixed.exit_code(), 1);
  EXPECT_THAT(mixed.err(), ::testing::HasSubstr("a sequence is given alone"));
}

TEST_F(Run, AFolderHoldsOneRun) {
  const std::vector<std::string> inline_run = arguments("result", {"--inline", "--agents", "cam0,cam1"});
  ASSERT_EQ(Program("coslam", inline_run).exit_code(), 0);
  const ResultFolder r = result("result");
  std::ofstream(r.path() / "notes.txt") << "mine";
  const std::string before = content_of(r.report());
  Program again("coslam", arguments("result", {"--inline", "--agents", "cam0"}));
  EXPECT_EQ(again.exit_code(), 1);
  EXPECT_THAT(again.err(), ::testing::HasSubstr("holds a run already"));
  EXPECT_EQ(content_of(r.report()), before) << "nothing is touched";
  Program forced("coslam", arguments("result", {"--inline", "--agents", "cam0", "--force"}));
  EXPECT_EQ(forced.exit_code(), 0) << forced.err();
  EXPECT_FALSE(std::filesystem::exists(r.trajectory("cam1"))) << "nothing of the run before";
  EXPECT_TRUE(std::filesystem::exists(r.path() / "notes.txt"));
}

TEST_F(Run, TheFolderOfAServersRunsIsNoResult) {
  const auto runs = scene_.folder() / "runs";
  std::filesystem::create_directory(runs);
  std::filesystem::create_symlink("20261123T084512Z-01", runs / "latest");
  Program run("coslam", arguments("runs", {"--inline", "--force"}));
  EXPECT_EQ(run.exit_code(), 1);
  EXPECT_THAT(run.err(), ::testing::HasSubstr("holds the runs of a server: name another folder with --out"));
}

TEST_F(Run, ProcessesAndInlineAgree) {
  Program processes("coslam", arguments("processes", {"--domain", std::to_string(domain_.number())}));
  ASSERT_EQ(processes.exit_code(), 0) << processes.err();
  Program in_one("coslam", arguments("inline", {"--inline"}));
  ASSERT_EQ(in_one.exit_code(), 0) << in_one.err();
  const auto configured = read_json(result("processes").report())["configuration"]["server"];
  EXPECT_EQ(configured["baseline_m"], SmallScene::kBaseline_m);
  EXPECT_EQ(configured, read_json(result("inline").report())["configuration"]["server"]);
  // To the bit; report.json has times in it.
  const std::filesystem::path processes_folder = result("processes").path(), inline_folder = result("inline").path();
  std::set<std::string> files = files_in(processes_folder);
  EXPECT_EQ(files, files_in(inline_folder));
  EXPECT_EQ(files.erase("report.json"), 1U);
  EXPECT_GE(files.size(), 11U);
  for (const std::string& file : files) {
    const std::string content = content_of(processes_folder / file);
    EXPECT_FALSE(content.empty()) << file;
    EXPECT_TRUE(content == content_of(inline_folder / file)) << file;
  }
}

}  // namespace
}  // namespace coslam::run_test
