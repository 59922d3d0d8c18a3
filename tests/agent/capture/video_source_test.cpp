// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <utility>
#include <vector>

#include "agent/capture/source.h"
#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::video_source_test {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 48;
const SourceOptions kOptions{0, {}, 10, kWidth, kHeight, "calib.yaml"};

class Video : public ::testing::Test {
 protected:
  Video() {
    cv::VideoWriter writer(file_, cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20,
                           {kWidth, kHeight});
    for (int i = 0; i < 8; ++i) writer.write(cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar::all(20 * i)));
  }
  test::TempFolder folder_;
  const std::string file_ = (folder_ / "clip.avi").string();
};

// As a camera's program writes it: JPEGs one after another.
TEST_F(Video, FramesWithoutTimesComeAtTheRateOfTheSequence) {
  const std::string file = (folder_ / "clip.mjpeg").string();
  std::ofstream out(file, std::ios::binary);
  for (int i = 0; i < 8; ++i) {
    std::vector<uchar> jpeg;
    cv::imencode(".jpg", cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar::all(20 * i)), jpeg);
    out.write(reinterpret_cast<const char*>(jpeg.data()), static_cast<std::streamsize>(jpeg.size()));
  }
  out.close();
  const auto source = open_source(file, kOptions);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(source->next()->capture_ns, to_ns(i / kOptions.rate_hz)) << i;
  EXPECT_FALSE(source->next());
}

using Bytes = std::string;

std::uint32_t number_at(const Bytes& b, std::size_t at) {
  std::uint32_t v = 0;
  for (std::size_t i = 0; i < 4; ++i) v = v << 8U | static_cast<unsigned char>(b.at(at + i));
  return v;
}
void set_number(Bytes* b, std::size_t at, std::uint32_t v) {
  for (std::size_t i = 0; i < 4; ++i) b->at(at + i) = static_cast<char>(v >> (24 - 8 * i));
}

// A clip in an MP4 file, of which the tests change what the writer does not let them choose.
class Mp4 : public ::testing::Test {
 protected:
  static constexpr int kFrames = 6;
  Mp4() {
    {
      cv::VideoWriter writer(file_, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 20, {kWidth, kHeight});
      for (int i = 0; i < kFrames; ++i) writer.write(cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar::all(30 * i)));
    }
    std::ifstream in(file_, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(in), {});
  }
  void store() { std::ofstream(file_, std::ios::binary) << bytes_; }
  std::size_t box(const char* name) const {
    const std::size_t at = bytes_.find(name);
    EXPECT_NE(at, Bytes::npos) << name;
    return at - 4;
  }
  // The last `frames` frames last `times` as long: a second entry in the table of durations.
  void stretch(std::uint32_t frames, std::uint32_t times) {
    const std::size_t at = box("stts");
    ASSERT_EQ(number_at(bytes_, at + 12), 1U);
    ASSERT_GT(box("moov"), box("mdat")) << "nothing that is pointed at moves";
    const std::uint32_t lasts = number_at(bytes_, at + 20);
    for (const char* around : {"moov", "trak", "mdia", "minf", "stbl", "stts"}) {
      set_number(&bytes_, box(around), number_at(bytes_, box(around)) + 8);
    }
    set_number(&bytes_, at + 12, 2);
    set_number(&bytes_, at + 16, kFrames - frames);
    Bytes more(8, 0);
    set_number(&more, 0, frames);
    set_number(&more, 4, times * lasts);
    bytes_.insert(at + 24, more);
    bytes_.replace(box("edts") + 4, 4, "free");  // what cuts the track at its old length
    store();
  }
  // The matrix of the track's header.
  void note_turn(int a, int b, int c, int d) {
    const std::size_t at = box("tkhd") + 48;
    constexpr std::int32_t kOne = 0x10000;
    const std::array<int, 9> matrix{a * kOne, b * kOne, 0, c * kOne, d * kOne, 0, 0, 0, 0x40000000};
    for (std::size_t i = 0; i < matrix.size(); ++i)
      set_number(&bytes_, at + 4 * i, static_cast<std::uint32_t>(matrix[i]));
    store();
  }
  test::TempFolder folder_;
  const std::string file_ = (folder_ / "clip.mp4").string();
  Bytes bytes_;
};

TEST_F(Mp4, TheStreamsTimesCount) {
  stretch(3, 4);
  const auto source = open_source(file_, kOptions);
  std::vector<double> times_s;
  while (const auto image = source->next()) times_s.push_back(to_seconds(image->capture_ns));
  ASSERT_EQ(times_s.size(), static_cast<std::size_t>(kFrames));
  const std::vector<double> expected{0, 0.05, 0.1, 0.15, 0.35, 0.55};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(times_s[i], expected[i], 0.0015) << i;
}

TEST_F(Mp4, AnEvenStreamIsPlayedEvenly) {
  const auto source = open_source(file_, kOptions);
  for (int i = 0; i < kFrames; ++i) EXPECT_EQ(source->next()->capture_ns, i * 50'000'000);
}

TEST_F(Mp4, FramesAreAsTheSensorGaveThem) {
  note_turn(0, 1, -1, 0);
  const auto image = open_source(file_, kOptions)->next();
  ASSERT_TRUE(image);
  EXPECT_EQ(image->grey.size(), cv::Size(kWidth, kHeight));
}

TEST_F(Mp4, UnlessOnlyTheTurnedOneHasTheCalibrationsSize) {
  note_turn(0, 1, -1, 0);
  SourceOptions options = kOptions;
  std::swap(options.width_px, options.height_px);
  const auto image = open_source(file_, options)->next();
  ASSERT_TRUE(image);
  EXPECT_EQ(image->grey.size(), cv::Size(kHeight, kWidth));
}

TEST_F(Mp4, WithoutItsIndexSaysSo) {
  const auto error = [&] { return test::error_of<UserError>([&] { open_source(file_, kOptions); }); };
  bytes_.resize(box("moov"));
  store();
  EXPECT_THAT(error(), HasSubstr("clip.mp4: is a video without its index, as of a recorder that was stopped"));
  bytes_.clear();
  store();
  EXPECT_THAT(error(), HasSubstr("clip.mp4: is empty"));
}

TEST_F(Video, PlaysAtTheContainersRate) {
  const auto source = open_source(file_, kOptions);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(source->about_left(), 8 - i);
    EXPECT_EQ(source->peek_ns(), i * 50'000'000);
    const auto image = source->next();
    ASSERT_TRUE(image) << i;
    EXPECT_EQ(image->frame, FrameId(static_cast<std::uint32_t>(i)));
    EXPECT_EQ(image->capture_ns, i * 50'000'000);
    EXPECT_EQ(image->grey.type(), CV_8UC1);
    EXPECT_NEAR(image->grey.at<uchar>(20, 20), 20 * i, 3);
  }
  EXPECT_FALSE(source->next());
  EXPECT_FALSE(source->peek_ns());
}

TEST_F(Video, SidecarGivesTheTimes) {
  folder_.write("clip.avi.timestamps.csv", "t_s\n0.0\n0.1\n0.25\n");
  const auto source = open_source(file_, kOptions);
  EXPECT_TRUE(source->skip());
  EXPECT_EQ(source->next()->capture_ns, 100'000'000);
  EXPECT_EQ(source->next()->capture_ns, 250'000'000);
  EXPECT_FALSE(source->next());  // the rest has no time
}

TEST_F(Video, SidecarMayLeaveTheExtensionOut) {
  folder_.write("clip.timestamps.csv", "0.0\n0.2\n");
  const auto source = open_source(file_, kOptions);
  EXPECT_EQ(source->next()->capture_ns, 0);
  EXPECT_EQ(source->next()->capture_ns, 200'000'000);
  folder_.write("clip.avi.timestamps.csv", "0.0\n0.3\n");
  const auto whole_name = open_source(file_, kOptions);
  EXPECT_TRUE(whole_name->skip());
  EXPECT_EQ(whole_name->next()->capture_ns, 300'000'000) << "the full name goes before";
}

TEST_F(Video, StartAndDuration) {
  SourceOptions options = kOptions;
  options.start_s = 0.1;
  options.duration_s = 0.1;
  const auto source = open_source(file_, options);
  EXPECT_EQ(source->about_left(), 2);
  const auto first = source->next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->frame, FrameId(0));
  EXPECT_EQ(first->capture_ns, 0);
  EXPECT_NEAR(first->grey.at<uchar>(20, 20), 40, 3);
  EXPECT_TRUE(source->skip());
  EXPECT_FALSE(source->skip());
  options.duration_s.reset();
  options.start_s = -0.7;
  EXPECT_EQ(open_source(file_, options)->next()->capture_ns, 700'000'000) << "so much later than the others";
  options.start_s = 9;
  EXPECT_THAT(test::error_of<UserError>([&] { open_source(file_, options); }), HasSubstr("no readable frame"));
}

TEST_F(Video, WrongSize) {
  SourceOptions options = kOptions;
  options.width_px = 640;
  EXPECT_THAT(test::error_of<UserError>([&] { open_source(file_, options); }), HasSubstr("clip.avi is 64x48 pixels"));
}

}  // namespace
}  // namespace coslam::video_source_test
