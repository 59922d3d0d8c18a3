// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/video/stream_decoder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

#include "common/image/image_file.h"
#include "tests/support/temp_folder.h"

namespace coslam::stream_decoder_test {
namespace {

class StreamDecoderTest : public testing::Test {
 protected:
  static constexpr int kFrames = 30;
  StreamDecoderTest() : wall_(200, 400, CV_8UC3) {
    cv::Mat coarse(25, 50, CV_8UC3);
    cv::RNG(3).fill(coarse, cv::RNG::UNIFORM, 0, 255);
    cv::resize(coarse, wall_, wall_.size(), 0, 0, cv::INTER_CUBIC);
  }
  cv::Mat frame(int i, cv::Size size) const { return wall_(cv::Rect({3 * i, i}, size)).clone(); }
  std::string write(const char* name, int backend, const char* format, cv::Size size) {
    const std::string file = (folder_ / name).string();
    cv::VideoWriter writer(file, backend, cv::VideoWriter::fourcc(format[0], format[1], format[2], format[3]), 20,
                           size);
    for (int i = 0; i < kFrames; ++i) writer.write(frame(i, size));
    return file;
  }
  // One JPEG after another, of the even ones in another size where it is given.
  std::string write_jpegs(cv::Size size, cv::Size of_even, std::size_t cut_bytes = 0) {
    const std::string file = (folder_ / "clip.mjpeg").string();
    std::ofstream out(file, std::ios::binary);
    for (int i = 0; i < 6; ++i) {
      std::vector<uchar> jpeg;
      cv::imencode(".jpg", frame(i, i % 2 == 0 ? of_even : size), jpeg);
      if (i == 3) jpeg.resize(jpeg.size() - std::min(jpeg.size(), cut_bytes));
      out.write(reinterpret_cast<const char*>(jpeg.data()), static_cast<std::streamsize>(jpeg.size()));
    }
    return file;
  }
  static std::string read(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::unique_ptr<StreamDecoder> opened(const std::string& file) { return StreamDecoder::open(file, false, &why_); }
  test::TempFolder folder_;
  cv::Mat wall_;
  std::string why_;
};

TEST_F(StreamDecoderTest, FramesAreThoseThatOthersDecode) {
  for (const std::string& file :
       {write("clip.mp4", cv::CAP_FFMPEG, "mp4v", {176, 144}), write("odd.mp4", cv::CAP_FFMPEG, "mp4v", {150, 98}),
        write("clip.avi", cv::CAP_OPENCV_MJPEG, "MJPG", {176, 144})}) {
    const auto decoder = opened(file);
    ASSERT_TRUE(decoder) << file;
    EXPECT_EQ(decoder->rate_hz(), 20);
    EXPECT_EQ(decoder->frames(), kFrames);
    EXPECT_EQ(decoder->turn_deg(), 0);
    cv::VideoCapture other(file, cv::CAP_FFMPEG);
    cv::Mat expected;
    int i = 0;
    for (; other.read(expected); ++i) {
      ASSERT_TRUE(decoder->grab()) << i;
      ASSERT_EQ(cv::norm(mat_of(decoder->bgr()), expected, cv::NORM_INF), 0) << file << " " << i;
      EXPECT_NEAR(decoder->time_s().value_or(-1), i / 20.0, 1e-9);
      EXPECT_FALSE(decoder->concealed());
    }
    EXPECT_EQ(i, kFrames);
    EXPECT_FALSE(decoder->grab());
  }
}

TEST_F(StreamDecoderTest, EachFrameHasItsOwnSize) {
  const auto decoder = opened(write_jpegs({160, 120}, {80, 60}));
  ASSERT_TRUE(decoder);
  for (int i = 0; i < 6; ++i) {
    ASSERT_TRUE(decoder->grab());
    EXPECT_EQ(mat_of(decoder->bgr()).size(), i % 2 == 0 ? cv::Size(80, 60) : cv::Size(160, 120)) << i;
  }
}

TEST_F(StreamDecoderTest, AnImageThatWasCutIsMadeUp) {
  const auto decoder = opened(write_jpegs({160, 120}, {160, 120}, 1500));
  ASSERT_TRUE(decoder);
  std::vector<bool> made_up;
  while (decoder->grab()) made_up.push_back(decoder->concealed() || decoder->bgr().empty());
  EXPECT_EQ(made_up, std::vector<bool>({false, false, false, true, false, false}));
}

TEST_F(StreamDecoderTest, WhatIsMadeFromADamagedFrameIsDamagedUntilTheNextKeyFrame) {
  const std::string file = write("clip.mp4", cv::CAP_FFMPEG, "mp4v", {176, 144});
  std::string octets = read(file);
  const std::size_t data = octets.find("mdat");
  ASSERT_NE(data, std::string::npos);
  // A stretch of the second group of pictures.
  const std::size_t media = octets.find("moov") - data;
  for (std::size_t i = 0; i < 150; ++i) octets.at(data + media * 6 / 10 + i) = static_cast<char>(0x5a);
  std::ofstream(file, std::ios::binary) << octets;

  const auto decoder = opened(file);
  ASSERT_TRUE(decoder);
  std::vector<bool> made_up;
  while (decoder->grab()) made_up.push_back(decoder->concealed());
  const auto first = std::ranges::find(made_up, true);
  ASSERT_NE(first, made_up.end());
  EXPECT_GT(first - made_up.begin(), 10);
  EXPECT_FALSE(made_up.back()) << "a key frame came";
  EXPECT_TRUE(std::is_sorted(first, made_up.end(), std::greater())) << "none in between is believed";
  EXPECT_GE(std::ranges::count(made_up, true), 2);
}

TEST_F(StreamDecoderTest, NoVideo) {
  EXPECT_FALSE(opened((folder_ / "not there.mp4").string()));
  EXPECT_EQ(why_, "No such file or directory");
  folder_.write("words.mp4", "these are words");
  EXPECT_FALSE(opened((folder_ / "words.mp4").string()));
  EXPECT_EQ(why_, StreamDecoder::kNotAVideo);
  EXPECT_FALSE(opened(folder_.path().string()));
}

TEST_F(StreamDecoderTest, NamesMayLookLikeProtocols) {
  const std::string file = write("clip.avi", cv::CAP_OPENCV_MJPEG, "MJPG", {64, 48});
  const std::string odd = (folder_ / "rtp:2 #?.avi").string();
  std::filesystem::rename(file, odd);
  EXPECT_TRUE(opened(odd));
}

TEST_F(StreamDecoderTest, SaysHowMuchIsMissing) {
  const std::string file = write("clip.mkv", cv::CAP_FFMPEG, "MJPG", {64, 48});
  const auto missing = [&] {
    const auto decoder = opened(file);
    EXPECT_EQ(decoder->videos(), 1);
    EXPECT_EQ(decoder->video(), 1);
    while (decoder->grab()) {
    }
    return decoder->missing_share();
  };
  EXPECT_EQ(missing(), 0);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  EXPECT_NEAR(missing(), 0.5, 0.1);
}

TEST_F(StreamDecoderTest, StopsForGood) {
  const auto decoder = opened(write("clip.avi", cv::CAP_OPENCV_MJPEG, "MJPG", {64, 48}));
  ASSERT_TRUE(decoder->grab());
  decoder->stop();
  EXPECT_FALSE(decoder->grab());
}

}  // namespace
}  // namespace coslam::stream_decoder_test
