// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "agent/capture/source.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "tests/support/temp_folder.h"

namespace coslam::list_source_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

constexpr int kWidth = 32, kHeight = 24;
const SourceOptions kOptions{0, {}, 10, kWidth, kHeight, "calib.yaml"};

class Lists : public ::testing::Test {
 protected:
  // An evenly grey image: its value tells which one it is.
  void image(const std::string& name, int grey, int width = kWidth, int height = kHeight) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    cv::imwrite(folder_ / name, cv::Mat(height, width, CV_8UC1, cv::Scalar(grey)));
  }
  void truncate(const std::string& name) {
    std::filesystem::resize_file(folder_ / name, std::filesystem::file_size(folder_ / name) * 2 / 3);
  }
  std::unique_ptr<ImageSource> open(const std::string& name, SourceOptions options = kOptions) {
    return open_source((folder_ / name).string(), options);
  }
  std::string error(const std::string& name, const SourceOptions& options = kOptions) {
    return test::error_of<UserError>([&] { open(name, options); });
  }
  static std::vector<std::pair<std::uint32_t, TimeNs>> play(ImageSource& source) {
    std::vector<std::pair<std::uint32_t, TimeNs>> frames;
    while (const auto image = source.next()) frames.emplace_back(image->frame.value, image->capture_ns);
    return frames;
  }
  test::TempFolder folder_;
};

TEST_F(Lists, Csv) {
  for (int i = 0; i < 3; ++i) image("img/" + std::to_string(i) + ".png", 50 * i);
  folder_.write("list.csv", "# t_s,file\n0.5,img/2.png\n0.75, img/1.png\r\n\n1.0,img/0.png\n");
  const auto source = open("list.csv");
  EXPECT_FALSE(source->live());
  EXPECT_EQ(source->peek_ns(), 500'000'000);
  const auto first = source->next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->frame, FrameId(0));
  EXPECT_EQ(first->grey.type(), CV_8UC1);
  EXPECT_EQ(first->grey.at<uchar>(5, 5), 100);
  EXPECT_EQ(source->peek_ns(), 750'000'000);
  EXPECT_THAT(play(*source), ElementsAre(Pair(1, 750'000'000), Pair(2, 1'000'000'000)));
  EXPECT_EQ(source->peek_ns(), std::nullopt);
  EXPECT_FALSE(source->skip());
}

TEST_F(Lists, SkipUsesUpTheFrameId) {
  for (int i = 0; i < 3; ++i) image(std::to_string(i) + ".png", i);
  const auto source = open(".");
  EXPECT_TRUE(source->skip());
  EXPECT_EQ(source->peek_ns(), 100'000'000);  // rate_hz of the options: there are no times
  const auto second = source->next();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->frame, FrameId(1));
  EXPECT_EQ(second->grey.at<uchar>(0, 0), 1);
  EXPECT_TRUE(source->skip());
  EXPECT_FALSE(source->skip());
  EXPECT_FALSE(source->next());
}

TEST_F(Lists, ACoveredLensGivesBlackImagesWithNoise) {
  for (int i = 0; i < 6; ++i) image(std::to_string(i) + ".png", 120);
  SourceOptions options = kOptions;
  options.covered = {{0.2, 0.4}};
  const auto source = open(".", options), again = open(".", options);
  EXPECT_TRUE(again->skip());  // the noise is that of the frame, whatever was read before
  for (int i = 0; i < 6; ++i) {
    const auto read = source->next();
    ASSERT_TRUE(read);
    EXPECT_EQ(read->frame.value, i);
    cv::Scalar mean, deviation;
    cv::meanStdDev(read->grey, mean, deviation);
    if (i == 2 || i == 3) {
      EXPECT_LT(mean[0], 12);
      EXPECT_GT(deviation[0], 1);
      EXPECT_LT(deviation[0], 5);
    } else {
      EXPECT_EQ(deviation[0], 0);
      EXPECT_EQ(mean[0], 120);
    }
    if (i == 0) continue;
    EXPECT_EQ(cv::norm(again->next()->grey, read->grey), 0);
  }
}

TEST_F(Lists, FolderWithTimes) {
  for (const char* name : {"000000.png", "000001.jpg", "000002.png"}) image(name, 9);
  folder_.write("times.txt", "0.0\n0.04\n0.09\n");
  EXPECT_THAT(play(*open(".")), ElementsAre(Pair(0, 0), Pair(1, 40'000'000), Pair(2, 90'000'000)));
  folder_.write("times.txt", "0.0\n0.04\n");
  EXPECT_THAT(error("."), HasSubstr("times.txt: 2 times for 3 images"));
  folder_.write("times.txt", "0.0\n0.04\n0.03\n");
  EXPECT_THAT(error("."), HasSubstr("times.txt:3: the time is earlier"));
  folder_.write("times.txt", "0.0\n0.04\n0.04\n");
  const auto source = open(".");
  EXPECT_THAT(play(*source), ElementsAre(Pair(0, 0), Pair(1, 40'000'000))) << "a repeated time costs an image";
}

TEST_F(Lists, NanosecondNames) {
  for (const char* name : {"1403638518077829376.png", "1403638518127829376.png"}) image(name, 9);
  EXPECT_THAT(play(*open(".")), ElementsAre(Pair(0, 0), Pair(1, 50'000'000)));
}

TEST_F(Lists, NamesMayBeTimesInOtherUnits) {
  for (const char* name : {"ms/1700000000000.png", "ms/1700000000100.png", "us/1700000000000000.png",
                           "us/1700000000100000.png", "s/1700000000.000000.png", "s/1700000000.100000.png"}) {
    image(name, 9);
  }
  for (const char* folder : {"ms", "us", "s"}) {
    EXPECT_THAT(play(*open(folder)), ElementsAre(Pair(0, 0), Pair(1, 100'000'000))) << folder;
  }
}

TEST_F(Lists, NamesThatAreNoTimesPlayAtTheRate) {
  for (const char* name : {"20240101.120000.png", "20240101.120001.png"}) image(std::string("named/") + name, 9);
  EXPECT_THAT(play(*open("named")), ElementsAre(Pair(0, 0), Pair(1, 100'000'000)));
}

TEST_F(Lists, CsvOfOtherPrograms) {
  for (const char* name : {"a.png", "b.png"}) image(name, 9);
  for (const char* text : {"0.0;a.png\n0.1;b.png\n", "0,0;a.png\n0,1;b.png\n", "0.0 a.png\n0.1 b.png\n",
                           "0.0,a.png,0.01\n0.1,b.png,0.01\n", "t;file\r\n0.0; a.png\r\n0.1; b.png\r\n"}) {
    folder_.write("list.csv", text);
    EXPECT_THAT(play(*open("list.csv")), ElementsAre(Pair(0, 0), Pair(1, 100'000'000))) << text;
  }
}

TEST_F(Lists, OfAssociationsTheColourImages) {
  for (const char* name : {"rgb/0.png", "rgb/1.png"}) image(name, 9);
  for (const char* text : {"5.0 rgb/0.png 5.01 depth/0.png\n5.1 rgb/1.png 5.11 depth/1.png\n",
                           "4.99 depth/0.png 5.0 rgb/0.png\n5.09 depth/1.png 5.1 rgb/1.png\n"}) {
    folder_.write("assoc.txt", text);
    EXPECT_THAT(play(*open("assoc.txt")), ElementsAre(Pair(0, 5'000'000'000), Pair(1, 5'100'000'000))) << text;
  }
}

TEST_F(Lists, NumericNamesAreInNumericalOrder) {
  image("10.png", 10);
  image("9.png", 9);
  EXPECT_EQ(open(".")->next()->grey.at<uchar>(0, 0), 9);
}

TEST_F(Lists, AMissingNumberIsAGapInTime) {
  const auto times_of = [&](const std::string& folder, const std::vector<std::string>& names) {
    for (const std::string& name : names) image(folder + "/" + name, 100);
    const auto source = open(folder);
    std::vector<TimeNs> times;
    for (const auto& [frame, t_ns] : play(*source)) times.push_back(t_ns);
    return times;
  };
  // At 10 Hz, as the options say.
  EXPECT_EQ(times_of("gap", {"000007.png", "000008.png", "000011.png", "000012.png"}),
            (std::vector<TimeNs>{0, 100'000'000, 400'000'000, 500'000'000}));
  EXPECT_EQ(times_of("fifth", {"10.png", "15.png", "20.png"}), (std::vector<TimeNs>{0, 100'000'000, 200'000'000}))
      << "one in five was kept";
  EXPECT_EQ(times_of("words", {"a1.png", "a2.png", "a5.png"}), (std::vector<TimeNs>{0, 100'000'000, 400'000'000}));
}

TEST_F(Lists, Euroc) {
  image("mav0/cam0/data/1403638518077829376.png", 9);
  image("mav0/cam0/data/1403638518127829376.png", 9);
  folder_.write("mav0/cam0/data.csv",
                "#timestamp [ns],filename\r\n1403638518077829376,1403638518077829376.png\r\n"
                "1403638518127829376,1403638518127829376.png\r\n");
  for (const char* name : {".", "mav0", "mav0/cam0"}) {
    EXPECT_THAT(play(*open(name)), ElementsAre(Pair(0, 0), Pair(1, 50'000'000))) << name;
  }
}

TEST_F(Lists, Tum) {
  image("rgb/1305031102.175304.png", 9);
  image("rgb/1305031102.211214.png", 9);
  folder_.write("rgb.txt",
                "# color images\n1305031102.175304 rgb/1305031102.175304.png\n"
                "1305031102.211214 rgb/1305031102.211214.png\n");
  EXPECT_THAT(play(*open(".")), ElementsAre(Pair(0, 0), Pair(1, 35'910'000)));
  EXPECT_EQ(play(*open("rgb.txt")).size(), 2u);
}

TEST_F(Lists, StartAndDurationCutTheSource) {
  for (int i = 0; i < 10; ++i) image("00000" + std::to_string(i) + ".png", i);
  SourceOptions options = kOptions;
  options.start_s = 0.25;
  options.duration_s = 0.3;
  const auto source = open(".", options);
  EXPECT_EQ(source->peek_ns(), 50'000'000);  // the image at 0.3 s
  EXPECT_THAT(play(*source), ElementsAre(Pair(0, 50'000'000), Pair(1, 150'000'000), Pair(2, 250'000'000)));
  options.start_s = 5;
  EXPECT_THAT(error(".", options), HasSubstr("no image lies in the time span"));
}

TEST_F(Lists, BadImagesComeWithTheirFault) {
  for (int i = 0; i < 6; ++i) image("00000" + std::to_string(i) + ".png", i);
  for (int i = 6; i < 8; ++i) image("00000" + std::to_string(i) + ".jpg", i);
  folder_.write("000000.png", "no image");
  truncate("000002.png");
  folder_.write("000003.png", "");
  image("000004.png", 4, kWidth / 2);  // another size in the middle
  truncate("000006.jpg");
  const auto source = open(".");
  std::vector<ImageFault> faults;
  while (const auto got = source->next()) faults.push_back(got->fault);
  using enum ImageFault;
  EXPECT_THAT(faults, ElementsAre(kUnreadable, kNone, kUnreadable, kUnreadable, kResized, kNone, kUnreadable, kNone));
}

TEST_F(Lists, WrongSizeNamesBothSizesAndBothFiles) {
  image("000000.png", 9, 40, 30);
  EXPECT_THAT(error("."), AllOf(HasSubstr("000000.png is 40x30 pixels"), HasSubstr("calib.yaml is for 32x24")));
  SourceOptions any_size = kOptions;
  any_size.width_px = any_size.height_px = 0;
  EXPECT_EQ(open(".", any_size)->next()->grey.cols, 40);
}

TEST_F(Lists, SaysWhatIsWrong) {
  EXPECT_THAT(error("nothing"), HasSubstr("there is no source"));
  EXPECT_THAT(error("."), HasSubstr("there is no image in the folder"));
  folder_.write("000000.png", "no image");
  EXPECT_THAT(error("."), AllOf(HasSubstr("none of the 1 images can be read"), HasSubstr("000000.png")));
  folder_.write("bad.csv", "# t_s,file\n0.0,a.png\n0.1:b.png\n");
  EXPECT_THAT(error("bad.csv"), HasSubstr("bad.csv:3: not a line `t_s,file`"));
  folder_.write("empty.csv", "t_s,file\n");
  EXPECT_THAT(error("empty.csv"), HasSubstr("there is no line `t_s,file` in it"));
  folder_.write("text.dat", "no video");
  EXPECT_THAT(error("text.dat"), HasSubstr("text.dat: neither a list of images (.csv, .txt) nor a video"));
  EXPECT_THAT(test::error_of<UserError>([] { open_source("ftp://x", kOptions); }), HasSubstr("of no known kind"));
}

TEST_F(Lists, AByteOrderMarkIsPassedOver) {
  image("0.png", 10);
  folder_.write("list.csv",
                "\xEF\xBB\xBF"
                "0.5,0.png\n");
  EXPECT_THAT(play(*open("list.csv")), ElementsAre(Pair(0, 500'000'000)));
}

TEST_F(Lists, OfDeepImagesTheLevelsThatAreUsedAreSpread) {
  std::filesystem::create_directories(folder_ / "deep");
  for (int i = 0; i < 2; ++i) {
    cv::Mat deep(kHeight, kWidth, CV_16UC1);
    for (int x = 0; x < kWidth; ++x) deep.col(x).setTo(8000 + 20 * x);
    cv::imwrite(folder_ / ("deep/" + std::to_string(i) + ".png"), deep);
  }
  const auto source = open("deep");
  const auto first = source->next(), second = source->next();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->grey.type(), CV_8UC1);
  EXPECT_GT(first->grey.at<uchar>(5, 31) - first->grey.at<uchar>(5, 0), 180);
  EXPECT_EQ(cv::norm(first->grey, second->grey, cv::NORM_INF), 0);
}

TEST_F(Lists, KittiHasItsTimesBesideTheFolders) {
  for (const char* camera : {"image_0", "image_1"}) {
    for (int i = 0; i < 2; ++i) image("06/" + std::string(camera) + "/00000" + std::to_string(i) + ".png", 50 * i);
  }
  folder_.write("06/times.txt", "0.0\n1.037e-01\n");
  for (const char* source : {"06", "06/image_0", "06/image_1", "06/image_1/"}) {
    EXPECT_THAT(play(*open(source)), ElementsAre(Pair(0, 0), Pair(1, 103'700'000))) << source;
  }
}

TEST_F(Lists, RawRecordingsOfKittiHaveDates) {
  for (int i = 0; i < 2; ++i) image("drive/image_00/data/000000000" + std::to_string(i) + ".png", 50 * i);
  folder_.write("drive/image_00/timestamps.txt", "2011-09-26 13:02:25.964389445\n2011-09-26 13:02:26.067989445\n");
  for (const char* source : {"drive", "drive/image_00", "drive/image_00/data"}) {
    EXPECT_THAT(play(*open(source)), ElementsAre(Pair(0, 0), Pair(1, 103'600'000))) << source;
  }
}

TEST_F(Lists, SayWhatIsThereInstead) {
  for (const char* name : {"a/1.npy", "a/2.npy", "a/note.txt"}) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    folder_.write(name, "x");
  }
  EXPECT_THAT(error("a"), HasSubstr("no image in the folder; it holds 2 files .npy"));
  std::filesystem::create_directories(folder_ / "b/one");
  EXPECT_THAT(error("b"), HasSubstr("it holds 1 folders: name one of them"));
  folder_.write("list.csv", "t_s,file\n0.0,img/0.png\n0.1,img/1.png\n");
  EXPECT_THAT(error("list.csv"), HasSubstr("0.png, which is not there"));
}

TEST_F(Lists, SayWhatHelpsAgainstAnotherSize) {
  image("c/0.png", 50);
  const auto of_size = [&](int width, int height) {
    SourceOptions options = kOptions;
    options.width_px = width;
    options.height_px = height;
    return error("c", options);
  };
  EXPECT_THAT(of_size(2 * kWidth, 2 * kHeight), HasSubstr("so are fx, fy, cx and cy: times 0.5"));
  EXPECT_THAT(of_size(kHeight, kWidth), HasSubstr("turned by 90 degrees"));
  EXPECT_THAT(of_size(kWidth + 8, kHeight), HasSubstr("cropped"));
}

TEST_F(Lists, SayARateThatNobodyTold) {
  for (int i = 0; i < 3; ++i) image("d/" + std::to_string(i) + ".png", 50);
  const auto said = [&](bool given) {
    const std::size_t before = warnings_given().size();
    SourceOptions options = kOptions;
    options.rate_is_given = given;
    open("d", options);
    return warnings_given().size() - before;
  };
  EXPECT_EQ(said(true), 0U);
  EXPECT_EQ(said(false), 1U);
  EXPECT_THAT(warnings_given().back().text, HasSubstr("have no times, and are taken to come 10 times a second"));
}

}  // namespace
}  // namespace coslam::list_source_test
