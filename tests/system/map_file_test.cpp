// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// `--map` and `coslam map` as a user meets them.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "common/dataset/result.h"
#include "common/dataset/trajectory.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam::map_file_test {
namespace {

using test::Program;
using test::SmallScene;
using ::testing::HasSubstr;

class MapFileOfRuns : public ::testing::Test {
 protected:
  // How `coslam` with these words ends.
  int coslam(const std::vector<std::string>& words) {
    Program program("coslam", words);
    const int code = program.exit_code();
    text_ = program.out() + program.err();
    return code;
  }
  int run(const std::string& agents, const std::string& map, const std::string& out) {
    return coslam({"run", scene_.sequence(), "--inline", "--agents", agents, "--map", file(map), "--out", file(out)});
  }
  std::string file(const std::string& name) const { return (scene_.folder() / name).string(); }
  ResultFolder folder(const std::string& name) const { return ResultFolder(scene_.folder() / name); }

  SmallScene scene_;
  std::string text_;
};

TEST_F(MapFileOfRuns, ASecondRunGoesOnWithIt) {
  ASSERT_EQ(run("cam0,cam1", "kept.map", "first"), 0) << text_;
  ASSERT_EQ(run("cam1", "kept.map", "second"), 0) << text_;
  EXPECT_THAT(text_, HasSubstr("going on with the map of "));
  EXPECT_FALSE(std::filesystem::exists(folder("second").trajectory("cam0"))) << "the frames of that run alone";
  const auto report = read_json(folder("second").report());
  EXPECT_EQ(report["agents"]["cam1"]["frames"], 30) << "of the second time alone";
  EXPECT_LE(load_tum(folder("second").trajectory("cam1")).size(), 30U);
  EXPECT_THAT(text_, HasSubstr("lengths are metres")) << "by the baseline of the first run";
  ASSERT_EQ(coslam({"map", "list", file("kept.map")}), 0) << text_;
  EXPECT_THAT(text_, HasSubstr("cam0: 30 frames"));
  EXPECT_THAT(text_, HasSubstr("cam1: 60 frames"));
  EXPECT_EQ(coslam({"map", "check", file("kept.map")}), 0) << text_;
  EXPECT_EQ(coslam({"map", "adjust", file("kept.map")}), 0) << text_;
  EXPECT_EQ(coslam({"map", "compact", file("kept.map")}), 0) << text_;
}

TEST_F(MapFileOfRuns, WhatIsExportedIsAResult) {
  ASSERT_EQ(run("cam0,cam1", "kept.map", "run"), 0) << text_;
  ASSERT_EQ(coslam({"map", "export", file("kept.map"), file("exported")}), 0) << text_;
  const auto report = read_json(folder("exported").report());
  ASSERT_EQ(report["maps"].size(), 1U);
  EXPECT_EQ(report["maps"][0]["agents"]["cam1"], 30);
  for (const char* agent : {"cam0", "cam1"}) {
    EXPECT_EQ(report["agents"][agent]["frames"], 30);
    EXPECT_EQ(load_tum(folder("exported").trajectory(agent)).size(), 30U);
  }
  ASSERT_EQ(coslam({"eval", file("exported"), scene_.sequence()}), 0) << text_;
  EXPECT_LT(read_json(folder("exported").evaluation())["ate_percent"].get<double>(), 0.75);
  EXPECT_EQ(coslam({"export", file("exported"), "--format", "ply", file("ply")}), 0) << text_;
  EXPECT_EQ(coslam({"map", "export", file("kept.map"), file("exported")}), 1) << "it holds a run";
}

TEST_F(MapFileOfRuns, OneMayBePutIntoAnother) {
  ASSERT_EQ(run("cam0,cam1", "a.map", "a"), 0) << text_;
  ASSERT_EQ(run("cam0,cam1", "b.map", "b"), 0) << text_;
  ASSERT_EQ(coslam({"map", "merge", file("a.map"), file("b.map")}), 0) << text_;
  EXPECT_THAT(text_, HasSubstr("map 1 of " + file("b.map")));
  ASSERT_EQ(coslam({"map", "list", file("a.map")}), 0) << text_;
  EXPECT_THAT(text_, HasSubstr("cam1-2: 30 frames"));
  EXPECT_EQ(coslam({"map", "merge", file("a.map"), file("a.map")}), 1);
}

TEST_F(MapFileOfRuns, WhatIsNoneIsRefusedAndKept) {
  std::ofstream(file("notes.txt")) << "no map\n";
  EXPECT_NE(run("cam0", "notes.txt", "run"), 0);
  EXPECT_THAT(text_, HasSubstr("notes.txt"));
  for (const char* what : {"list", "check", "adjust", "compact"}) {
    EXPECT_EQ(coslam({"map", what, file("notes.txt")}), 1) << what;
    EXPECT_EQ(coslam({"map", what, file("none.map")}), 1) << what;
  }
  std::ifstream kept(file("notes.txt"));
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(kept), {}), "no map\n");
}

}  // namespace
}  // namespace coslam::map_file_test
