// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/frame_list.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::frame_list_test {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kRate_hz = 10;

class FrameLists : public ::testing::Test {
 protected:
  FrameList named(const std::vector<std::string>& names) {
    std::filesystem::remove_all(folder_ / "images");
    for (const std::string& name : names) folder_.write("images/" + name, "");
    return list_folder(folder_ / "images", kRate_hz);
  }
  static std::vector<TimeNs> times_ms(const FrameList& list) {
    std::vector<TimeNs> times;
    for (const ListedFrame& frame : list.frames) times.push_back(frame.source_ns / 1'000'000);
    return times;
  }
  test::TempFolder folder_;
};

TEST_F(FrameLists, TimesInNamesArePlayed) {
  EXPECT_THAT(times_ms(named({"cam0_1403638518.05.png", "cam0_1403638518.10.png", "cam0_1403638518.20.png"})),
              ElementsAre(0, 50, 150));
  EXPECT_THAT(times_ms(named({"20140624_193559950.png", "20140624_193600000.png"})), ElementsAre(0, 50));
}

TEST_F(FrameLists, NumbersWithAPointAreTimesWhereTheirRateIsThatOfACamera) {
  const FrameList times = named({"9.95.png", "10.0.png", "10.1.png"});
  EXPECT_THAT(times_ms(times), ElementsAre(9950, 10'000, 10'100));
  EXPECT_THAT(times.guesses, ElementsAre(EndsWith("images: the names of its images are taken for times in seconds")));
  const FrameList numbers = named({"1.0001.png", "1.0002.png", "1.0004.png"});
  EXPECT_THAT(times_ms(numbers), ElementsAre(0, 100, 300));
  EXPECT_THAT(numbers.guesses.back(),
              EndsWith("images: as times in seconds the names of its images would be 0.000200000 s apart; "
                       "the names of its images are not taken for times"));
}

TEST_F(FrameLists, DatesOfWholeSecondsAreNoTimes) {
  const FrameList list = named({"IMG_20140624_193559.png", "IMG_20140624_193600.png", "IMG_20140624_193601.png"});
  EXPECT_THAT(times_ms(list), ElementsAre(0, 100, 200));
  EXPECT_THAT(list.guesses, ElementsAre(HasSubstr("images: its images are named by dates of whole seconds; ")));
}

TEST_F(FrameLists, OfTwoCamerasAFolderIsRefusedUnlessItHasATimeForEach) {
  const std::vector<std::string> names = {"left_0.png", "left_1.png", "right_0.png", "right_1.png"};
  EXPECT_THAT(test::error_of<UserError>([&] { named(names); }), HasSubstr("images: images of 2 cameras? left_ (2), "));
  for (const std::string& name : names) folder_.write("timed/" + name, "");
  folder_.write("timed/times.txt", "0\n0.1\n0.2\n0.3\n");
  EXPECT_THAT(times_ms(list_folder(folder_ / "timed", kRate_hz)), ElementsAre(0, 100, 200, 300));
}

TEST_F(FrameLists, TimesBesideImages) {
  for (const char* name : {"images/00000.png", "images/00001.png"}) folder_.write(name, "");
  folder_.write("images/timestamps.txt", "0.0\n0.3\n");
  EXPECT_THAT(times_ms(list_folder(folder_ / "images", kRate_hz)), ElementsAre(0, 300));
  std::filesystem::remove(folder_ / "images/timestamps.txt");
  folder_.write("times.txt", "00000 1449234100.0 12.5\n00001 1449234100.2 12.5\n");
  for (const char* source : {"", "images"}) {
    EXPECT_THAT(times_ms(list_folder(folder_ / source, kRate_hz)), ElementsAre(0, 200)) << "as TUM has them";
  }
  folder_.write("times.txt", "00001 1449234100.0 12.5\n00002 1449234100.2 12.5\n");
  EXPECT_THAT(test::error_of<UserError>([&] { list_folder(folder_ / "images", kRate_hz); }),
              EndsWith("times.txt: image 1 is 00001 there, and 00000.png in the folder"));
}

TEST_F(FrameLists, EurocMayHaveMoreColumns) {
  folder_.write("data.csv",
                "#timestamp [ns],filename,exposure [ns]\n1403638518000000000,a.png,1\n"
                "1403638518050000000,b.png,1\n");
  const FrameList list = list_folder(folder_.path(), kRate_hz);
  EXPECT_THAT(times_ms(list), ElementsAre(0, 50));
  EXPECT_EQ(list.frames.front().file, folder_ / "data/a.png");
}

TEST_F(FrameLists, CsvWithQuotesOrBackslashes) {
  const FrameList quoted =
      list_csv(folder_.write("quoted.csv", "\"t_s\",\"file\"\n\"0.0\",\"a.png\"\n\"0.1\",\"b.png\"\n"));
  EXPECT_THAT(times_ms(quoted), ElementsAre(0, 100));
  EXPECT_EQ(quoted.frames.front().file, folder_ / "a.png");
  EXPECT_THAT(quoted.guesses, IsEmpty());
  const FrameList windows = list_csv(folder_.write("windows.csv", "0.0,img\\a.png\n0.1,img\\b.png\n"));
  EXPECT_EQ(windows.frames.front().file, folder_ / "img/a.png");
  EXPECT_THAT(windows.guesses,
              ElementsAre(EndsWith("windows.csv: backslashes in the names of its files are read as /")));
}

TEST_F(FrameLists, Utf16IsSaid) {
  const auto file = folder_.write("list.csv", std::string("\xFF\xFEt\0_\0", 6));
  EXPECT_THAT(test::error_of<UserError>([&] { list_csv(file); }),
              EndsWith("list.csv: is written in UTF-16; it has to be UTF-8 or ASCII"));
}

}  // namespace
}  // namespace coslam::frame_list_test
