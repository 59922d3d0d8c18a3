// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/image_names.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::image_names_test {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::IsEmpty;

using Paths = std::vector<std::filesystem::path>;

Paths in_order(const std::vector<std::string>& names) {
  test::TempFolder folder;
  for (const std::string& name : names) folder.write(name, "");
  Paths files;
  for (const auto& file : images_in(folder.path())) files.push_back(file.filename());
  return files;
}

TEST(ImageNames, AreInTheOrderOfTheirNumbers) {
  EXPECT_THAT(in_order({"10.png", "9.PNG", "100.jpg"}), ElementsAre("9.PNG", "10.png", "100.jpg"));
  EXPECT_THAT(in_order({"0.png", "-2.png", "-10.png", "10.png"}), ElementsAre("-10.png", "-2.png", "0.png", "10.png"));
  EXPECT_THAT(in_order({"img_0.png", "img_-2.png", "img_-10.png"}),
              ElementsAre("img_-10.png", "img_-2.png", "img_0.png"));
  EXPECT_THAT(in_order({"a10_2.png", "a9_10.png", "a9_9.png", "a.png"}),
              ElementsAre("a.png", "a9_9.png", "a9_10.png", "a10_2.png"));
  EXPECT_THAT(in_order({"2.webp", "1.jp2", "3.ppm", "4.gif"}), ElementsAre("1.jp2", "2.webp", "3.ppm"));
  EXPECT_THAT(in_order({"._0.png", ".1.png", "2.png", "notes.txt"}), ElementsAre("2.png")) << "hidden ones";
}

Paths of_one(const Paths& files, std::vector<std::string>* guesses = nullptr) {
  std::vector<std::string> said;
  return of_one_camera("walk", files, guesses != nullptr ? guesses : &said);
}
std::string refused(const Paths& files) {
  return test::error_of<UserError>([&] { of_one(files); });
}

TEST(ImageNames, OfTwoCamerasAreRefused) {
  EXPECT_EQ(refused({"left_0.png", "left_1.png", "left_2.png", "right_0.png", "right_1.png"}),
            "walk: images of 2 cameras? left_ (3), right_ (2): give each a folder or a list.csv");
  EXPECT_THAT(refused({"cam0_10.png", "cam0_11.png", "cam1_10.png", "cam1_11.png"}),
              EndsWith("images of 2 cameras? cam0_ (2), cam1_ (2): give each a folder or a list.csv"));
  EXPECT_THAT(refused({"0.jpg", "0.png", "1.jpg", "1.png"}),
              EndsWith("images of 2 cameras? .jpg (2), .png (2): give each a folder or a list.csv"));
}

TEST(ImageNames, OfOneCameraMayDifferInMore) {
  for (const Paths& files : std::vector<Paths>{{"0.png", "1.jpg", "2.png"},
                                               {"-1.png", "-2.png", "1.png", "2.png"},
                                               {"img_-2.png", "img_-1.png", "img_0.png", "img_1.png"},
                                               {"a.png", "b.png", "tree.png"},
                                               {"frame8.png", "frame9.png", "frame10.png", "frame11.png"},
                                               {"IMG_1.png", "IMG_2.png", "IMG_3.png", "cover.png"},
                                               {"5_01.png", "5_02.png", "6_01.png", "6_02.png"}}) {
    EXPECT_EQ(of_one(files), files);
  }
}

TEST(ImageNames, DepthBesideColourIsLeftOut) {
  std::vector<std::string> guesses;
  EXPECT_THAT(of_one({"frame-0.color.png", "frame-0.depth.png", "frame-1.color.png", "frame-1.depth.png"}, &guesses),
              ElementsAre("frame-0.color.png", "frame-1.color.png"));
  EXPECT_THAT(guesses, ElementsAre("walk: 2 images of depth are left out, as frame-0.depth.png"));
  EXPECT_THAT(of_one({"depth_0.png", "depth_1.png"}), ElementsAre("depth_0.png", "depth_1.png")) << "there is no other";
  EXPECT_THAT(refused({"depth_left_0.png", "depth_left_1.png", "depth_right_0.png", "depth_right_1.png"}),
              EndsWith("2 cameras? depth_left_ (2), depth_right_ (2): give each a folder or a list.csv"));
}

TEST(ImageNames, TheNumberThatDiffersCounts) {
  EXPECT_THAT(numbers_of({"7.png", "8.png", "11.png"}), ElementsAre(7, 8, 11));
  EXPECT_THAT(numbers_of({"frame0007.png", "frame0011.png"}), ElementsAre(7, 11));
  EXPECT_THAT(numbers_of({"cam2_-3_of_10.png", "cam2_-4_of_10.png"}), ElementsAre(3, 4));
  EXPECT_THAT(numbers_of({"-2.png", "1.png"}), ElementsAre(-2, 1));
  EXPECT_THAT(numbers_of({"img_-2.png", "img_1.png"}), ElementsAre(-2, 1));
  for (const Paths& none : std::vector<Paths>{{"a.png", "b.png"},
                                              {"1_1.png", "2_2.png"},
                                              {"a1.png", "b2.png"},
                                              {"2.png", "1.png"},
                                              {"7.png", "99999999999999999999.png"},
                                              {}}) {
    EXPECT_THAT(numbers_of(none), IsEmpty());
  }
}

TEST(ImageNames, TimesInThem) {
  struct Case {
    const char* name = nullptr;
    WrittenTime time;
    TimeUnit unit = TimeUnit::kSeconds;
    bool vague = false, coarse = false;
  };
  constexpr auto kWhole = TimeUnit::kNanoseconds;
  for (const Case& c : {
           Case{"1403638518077829376", {1403638518077829376, 0}, kWhole},
           Case{"cam0_1403638518077829376", {1403638518077829376, 0}, kWhole},
           Case{"123456789012", {123456789012, 0}, kWhole},
           Case{"1403638518.05", {1403638518, 50'000'000}},
           Case{"cam0_1403638518.050000", {1403638518, 50'000'000}},
           Case{"000007_1403638518.050000.color", {1403638518, 50'000'000}},
           Case{"1403638518_050000000", {1403638518, 50'000'000}},
           Case{"12.05", {12, 50'000'000}, TimeUnit::kSeconds, true},
           Case{"2014-06-24T19-35-18.050000", {1403638518, 50'000'000}},
           Case{"20140624_193518050", {1403638518, 50'000'000}},
           Case{"IMG_20140624_193518", {1403638518, 0}, TimeUnit::kSeconds, false, true},
       }) {
    const NamedTimes named = times_in_names({std::string(c.name) + ".png"});
    EXPECT_THAT(named.times, ElementsAre(c.time)) << c.name;
    EXPECT_EQ(named.unit, c.unit) << c.name;
    EXPECT_EQ(named.vague, c.vague) << c.name;
    EXPECT_EQ(named.coarse, c.coarse) << c.name;
  }
  for (const char* none : {"000123", "frame_000123", "IMG20140624193518", "shot1.0001", "img_12.05",
                           "20149924_193518050", "1403638518_5", "a", ""}) {
    EXPECT_THAT(times_in_names({std::string(none) + ".png"}).times, IsEmpty()) << none;
  }
  EXPECT_THAT(times_in_names({"1403638518.05.png", "7.png"}).times, IsEmpty()) << "not all are";
}

Paths numbered(const std::vector<std::int64_t>& numbers) {
  Paths files;
  for (const std::int64_t number : numbers) files.push_back("shot_" + std::to_string(number) + ".png");
  return files;
}

TEST(ImageNames, NumbersOfAClockAreTimes) {
  for (const auto& times : std::vector<std::vector<std::int64_t>>{{98'765'400'000, 98'765'466'667, 98'765'533'333},
                                                                  {0, 33'333, 66'667, 100'000, 166'667},
                                                                  {12'345'678, 12'345'745, 12'345'811, 12'345'945},
                                                                  {213, 262, 311, 363, 412, 462, 512, 561, 611}}) {
    const NamedTimes named = times_in_names(numbered(times));
    ASSERT_EQ(named.times.size(), times.size());
    EXPECT_EQ(named.unit, TimeUnit::kNanoseconds);
    EXPECT_EQ(named.times.back(), (WrittenTime{times.back(), 0}));
  }
  for (const auto& counted : std::vector<std::vector<std::int64_t>>{{7, 8, 9, 11},
                                                                    {0, 100, 200, 300},
                                                                    {10, 20, 29, 39},
                                                                    {1'000'000, 1'000'001, 1'000'002},
                                                                    {20'140'624'193'500, 20'140'624'193'505},
                                                                    {50, 100, 150, 200, 300, 350, 400, 450, 500, 550},
                                                                    {0, 70, 5'000, 20'000, 90'000},
                                                                    {}}) {
    EXPECT_THAT(times_in_names(numbered(counted)).times, IsEmpty());
  }
}

}  // namespace
}  // namespace coslam::image_names_test
