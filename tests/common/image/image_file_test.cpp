// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/image/image_file.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "tests/support/temp_folder.h"

namespace coslam {
namespace {

using Octets = std::vector<std::uint8_t>;

// Smooth colours with noise.
cv::Mat picture(int type, cv::Size size = {97, 61}) {
  cv::Mat coarse(7, 11, CV_MAKETYPE(CV_32F, CV_MAT_CN(type))), noise(size, coarse.type()), out;
  cv::RNG random(5);
  random.fill(coarse, cv::RNG::UNIFORM, 0.0, 1.0);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 0.03);
  cv::resize(coarse, out, size, 0, 0, cv::INTER_CUBIC);
  out += noise;
  out.convertTo(out, type, CV_MAT_DEPTH(type) == CV_16U ? 65535 : 255);
  return out;
}

Octets encoded(const char* kind, const cv::Mat& image, const std::vector<int>& how = {}) {
  Octets octets;
  cv::imencode(kind, image, octets, how);
  return octets;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && !a.empty() && cv::norm(a, b, cv::NORM_INF) == 0;
}

void expect_as_opencv_reads(const Octets& octets, const std::string& which) {
  const cv::Mat grey = cv::imdecode(octets, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  EXPECT_TRUE(same(decode_grey(octets), grey)) << which;
  EXPECT_TRUE(same(decode_unchanged(octets), cv::imdecode(octets, cv::IMREAD_UNCHANGED))) << which;
}

TEST(ImageFile, PixelsOfAPngAreThoseThatOpenCvReads) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4})
    expect_as_opencv_reads(encoded(".png", picture(type)), std::to_string(type));
  expect_as_opencv_reads(encoded(".png", picture(CV_8UC1), {cv::IMWRITE_PNG_BILEVEL, 1}), "of two levels");
}

TEST(ImageFile, PixelsOfAJpegAreThoseThatOpenCvReads) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    for (const int quality : {20, 75, 100})
      expect_as_opencv_reads(encoded(".jpg", picture(type), {cv::IMWRITE_JPEG_QUALITY, quality}), std::to_string(type));
    expect_as_opencv_reads(encoded(".jpg", picture(type), {cv::IMWRITE_JPEG_PROGRESSIVE, 1}), "progressive");
  }
}

TEST(ImageFile, PixelsOfLosslessFormsAreThoseThatWereWritten) {
  for (const char* kind : {".pgm", ".bmp", ".tiff"}) {
    const cv::Mat grey = picture(CV_8UC1);
    EXPECT_TRUE(same(decode_grey(encoded(kind, grey)), grey)) << kind;
  }
  for (const char* kind : {".pgm", ".tiff"}) {
    const cv::Mat deep = picture(CV_16UC1);
    EXPECT_TRUE(same(decode_grey(encoded(kind, deep)), deep)) << kind;
  }
  for (const char* kind : {".ppm", ".bmp", ".tiff"}) {
    const cv::Mat colours = picture(CV_8UC3);
    EXPECT_TRUE(same(decode_unchanged(encoded(kind, colours)), colours)) << kind;
    cv::Mat grey;
    cv::cvtColor(colours, grey, cv::COLOR_BGR2GRAY);
    EXPECT_TRUE(same(decode_grey(encoded(kind, colours)), grey)) << kind;
  }
}

TEST(ImageFile, LossyFormsAreReadToo) {
  const cv::Mat smooth(48, 64, CV_8UC3, cv::Scalar(40, 120, 200));
  for (const char* kind : {".webp", ".jp2"}) {
    const cv::Mat read = decode_unchanged(encoded(kind, smooth));
    ASSERT_EQ(read.type(), CV_8UC3) << kind;
    EXPECT_LE(cv::norm(read, smooth, cv::NORM_INF), 4) << kind;
  }
}

TEST(ImageFile, WhatIsDamagedIsEmpty) {
  for (const char* kind : {".png", ".jpg", ".tiff"}) {
    Octets octets = encoded(kind, picture(CV_8UC1));
    octets.resize(octets.size() / 2);
    EXPECT_TRUE(decode_grey(octets).empty()) << kind;
  }
  Octets octets = encoded(".png", picture(CV_8UC1));
  octets[octets.size() / 2] ^= 0x55;
  EXPECT_TRUE(decode_grey(octets).empty()) << "the sum of its octets tells";
  EXPECT_TRUE(decode_grey({}).empty());
  const std::string words = "these are words";
  EXPECT_TRUE(decode_grey(Octets(words.begin(), words.end())).empty());
  EXPECT_TRUE(decode_grey(read_octets("/no/such/image.png")).empty());
}

TEST(ImageFile, WhatIsWrittenIsReadByOpenCv) {
  const test::TempFolder folder;
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3}) {
    const std::string file = (folder / "image.png").string();
    ASSERT_TRUE(write_image_file(file, picture(type)));
    EXPECT_TRUE(same(cv::imread(file, cv::IMREAD_UNCHANGED), picture(type))) << type;
  }
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const std::string file = (folder / "image.JPG").string();
    ASSERT_TRUE(write_image_file(file, picture(type)));
    EXPECT_EQ(read_octets(file), encoded(".jpg", picture(type))) << type;
  }
  EXPECT_FALSE(write_image_file(folder / "image.xyz", picture(CV_8UC1)));
  EXPECT_FALSE(write_image_file(folder / "no" / "such" / "folder.png", picture(CV_8UC1)));
}

TEST(ImageFile, JpegsAreThoseThatOpenCvWrites) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    for (const int quality : {12, 60}) {
      EXPECT_EQ(encode_jpeg(picture(type), quality, true),
                encoded(".jpg", picture(type), {cv::IMWRITE_JPEG_QUALITY, quality, cv::IMWRITE_JPEG_OPTIMIZE, 1}));
    }
  }
}

}  // namespace
}  // namespace coslam
