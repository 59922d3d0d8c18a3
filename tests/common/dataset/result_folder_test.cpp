// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/result_folder.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "common/dataset/result.h"
#include "common/dataset/trajectory.h"
#include "tests/support/temp_folder.h"

namespace coslam::result_folder_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class ResultFolderTest : public ::testing::Test {
 protected:
  // Of two maps: a and b in the one, c in the other.
  void write_run() const {
    for (const char* agent : {"a", "b"}) save_tum(result_.trajectory(agent), {});
    save_tum(result_.of_map(MapId(12)).trajectory("c"), {});
  }
  void write_report() const {
    write_json(result_.report(),
               {{"agents", {{"a", {{"frames", 9}}}, {"b", {{"frames", 9}}}, {"c", {{"frames", 9}}}}},
                {"maps", {{{"map", 3}, {"agents", {{"a", 9}, {"b", 8}}}}, {{"map", 12}, {"agents", {{"c", 7}}}}}}});
  }

  test::TempFolder temp_;
  const ResultFolder result_{temp_ / "out"};
};

TEST_F(ResultFolderTest, AMapApartHasFilesOfItsOwn) {
  const ResultFolder apart = result_.of_map(MapId(12));
  EXPECT_EQ(apart.path(), temp_ / "out/maps/12");
  EXPECT_EQ(apart.points(), temp_ / "out/maps/12/points.csv");
  EXPECT_EQ(apart.live("c"), temp_ / "out/maps/12/live/c.tum");
  EXPECT_EQ(apart.tracks("c"), temp_ / "out/tracks/c.csv") << "images belong to the run";
  EXPECT_EQ(apart.report(), result_.report());
}

TEST_F(ResultFolderTest, ContentsAreWhatTheReportLists) {
  write_run();
  write_report();
  save_tum(result_.trajectory("of_another_run"), {});
  save_tum(result_.of_map(MapId(7)).trajectory("c"), {});
  const ResultContents contents = contents_of(result_);
  EXPECT_TRUE(contents.reported);
  EXPECT_THAT(contents.agents, ElementsAre("a", "b", "c"));
  ASSERT_THAT(contents.maps, SizeIs(2));
  EXPECT_EQ(contents.maps[0].id, MapId(3));
  EXPECT_EQ(contents.maps[0].folder.path(), result_.path());
  EXPECT_THAT(contents.maps[0].agents, ElementsAre("a", "b"));
  EXPECT_EQ(contents.maps[1].id, MapId(12));
  EXPECT_EQ(contents.maps[1].folder.path(), result_.of_map(MapId(12)).path());
  EXPECT_THAT(contents.maps[1].agents, ElementsAre("c"));
}

TEST_F(ResultFolderTest, WithoutAReportContentsAreWhatLiesThere) {
  write_run();
  temp_.write("out/tracks/lost.csv", "");
  temp_.write("out/maps/notes/x", "");
  const ResultContents contents = contents_of(result_);
  EXPECT_FALSE(contents.reported);
  EXPECT_THAT(contents.agents, ElementsAre("a", "b", "c", "lost"));
  ASSERT_THAT(contents.maps, SizeIs(2));
  EXPECT_THAT(contents.maps[0].agents, ElementsAre("a", "b"));
  EXPECT_EQ(contents.maps[1].id, MapId(12));
  EXPECT_THAT(contents_of(ResultFolder(temp_ / "nothing")).maps, SizeIs(1));
}

TEST_F(ResultFolderTest, ContentsOfARunThatNeverMapped) {
  write_json(result_.report(), {{"agents", {{"a", {{"frames", 9}}}}}, {"maps", nlohmann::json::array()}});
  const ResultContents contents = contents_of(result_);
  ASSERT_THAT(contents.maps, SizeIs(1));
  EXPECT_THAT(contents.maps[0].agents, IsEmpty());
}

TEST_F(ResultFolderTest, AReportOfSomethingElseIsAnError) {
  write_json(result_.report(), {{"maps", {1, 2}}});
  EXPECT_THAT(test::error_of<UserError>([&] { contents_of(result_); }),
              HasSubstr("report.json: not the report of a run"));
}

TEST_F(ResultFolderTest, FindsARunAndTheLatestOfAServer) {
  write_run();
  EXPECT_EQ(find_result(temp_ / "out").path(), temp_ / "out");
  temp_.write("runs/20261123T084512Z-1/report.json", "{}");
  std::filesystem::create_symlink("20261123T084512Z-1", temp_ / "runs/latest");
  EXPECT_EQ(find_result(temp_ / "runs").path(), temp_ / "runs/20261123T084512Z-1");
  EXPECT_EQ(find_result(temp_ / "runs/latest").path(), temp_ / "runs/latest");
}

TEST_F(ResultFolderTest, SaysWhereThereIsNoRun) {
  const auto error = [&](const char* name) { return test::error_of<UserError>([&] { find_result(temp_ / name); }); };
  EXPECT_THAT(error("nowhere"), HasSubstr("nowhere: there is no such result folder"));
  temp_.write("other/notes.txt", "");
  EXPECT_THAT(error("other"), HasSubstr("other holds no run, and no link `latest`"));
  std::filesystem::create_symlink("gone", temp_ / "other/latest");
  EXPECT_THAT(error("other"), HasSubstr("other/latest leads to no folder"));
}

TEST_F(ResultFolderTest, ASequenceIsNoRun) {
  temp_.write("scene/sequence.yaml", "agents: []\n");
  temp_.write("scene/calibration/left.yaml", "");
  EXPECT_TRUE(ResultFolder(temp_ / "scene").holds_run());
  EXPECT_FALSE(ResultFolder(temp_ / "scene").holds_more_than_inputs());
  EXPECT_THAT(test::error_of<UserError>([&] { find_result(temp_ / "scene"); }), HasSubstr("it is a sequence"));
  write_run();
  EXPECT_TRUE(result_.holds_more_than_inputs());
}

TEST_F(ResultFolderTest, SaysWhatItWouldRemove) {
  for (const char* name : {"sequence.yaml", "calibration/left.yaml", "maps/2/map.ply", "own_body/left.png"})
    EXPECT_TRUE(result_.would_remove(result_.path() / name)) << name;
  for (const char* name : {"left.mp4", "images/0.png", "."}) {
    EXPECT_FALSE(result_.would_remove(result_.path() / name)) << name;
  }
  EXPECT_FALSE(result_.would_remove(temp_ / "sequence.yaml"));
}

TEST_F(ResultFolderTest, NamesTrajectoriesThatAreMissing) {
  write_json(result_.report(), {{"agents", {{"left", {{"frames", 3}}}, {"right", {{"frames", 3}}}}},
                                {"maps", {{{"map", 1}, {"agents", {{"left", 3}, {"right", 0}}}}}}});
  EXPECT_THAT(contents_of(result_).missing, ::testing::ElementsAre(result_.trajectory("left")));
}

TEST_F(ResultFolderTest, RemovesARunAndNothingElse) {
  write_run();
  write_report();
  temp_.write("out/points.csv.new", "a part of a run that was killed");
  temp_.write("out/notes.txt", "mine");
  temp_.write("out/maps/city/notes.txt", "mine");
  EXPECT_TRUE(result_.holds_run());
  result_.remove_run();
  EXPECT_FALSE(result_.holds_run());
  EXPECT_FALSE(std::filesystem::exists(temp_ / "out/maps/12"));
  EXPECT_FALSE(std::filesystem::exists(temp_ / "out/points.csv.new"));
  EXPECT_TRUE(std::filesystem::exists(temp_ / "out/notes.txt"));
  EXPECT_TRUE(std::filesystem::exists(temp_ / "out/maps/city/notes.txt"));
}

}  // namespace
}  // namespace coslam::result_folder_test
