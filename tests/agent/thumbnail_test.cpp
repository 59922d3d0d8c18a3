// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/thumbnail.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/model/thumbnail.h"

namespace coslam::thumbnail_test {
namespace {

cv::Mat ramp(cv::Size size) {
  cv::Mat image(size, CV_8UC1);
  for (int x = 0; x < size.width; ++x) image.col(x).setTo(255 * x / size.width);
  return image;
}

TEST(Thumbnail, IsTheImageMadeSmall) {
  const cv::Mat seen = cv::imdecode(thumbnail_jpeg(ramp({640, 480})), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(seen.size(), cv::Size(192, 144));
  EXPECT_EQ(seen.type(), CV_8UC1);
  cv::Mat off;
  cv::absdiff(seen, ramp({192, 144}), off);
  EXPECT_LT(cv::mean(off)[0], 3);
  EXPECT_EQ(cv::imdecode(thumbnail_jpeg(ramp({480, 640})), cv::IMREAD_UNCHANGED).size(), cv::Size(144, 192));
}

TEST(Thumbnail, ASmallImageIsNotEnlarged) {
  EXPECT_EQ(cv::imdecode(thumbnail_jpeg(ramp({80, 60})), cv::IMREAD_UNCHANGED).size(), cv::Size(80, 60));
}

TEST(Thumbnail, FitsEvenWhereTheImageIsNoise) {
  for (const cv::Size size : {cv::Size(192, 192), cv::Size(1920, 1080), cv::Size(60, 2000)}) {
    cv::Mat noise(size, CV_8UC1);
    cv::randu(noise, 0, 256);
    const auto jpeg = thumbnail_jpeg(noise);
    EXPECT_LE(jpeg.size(), kMostThumbnailBytes) << size;
    EXPECT_FALSE(cv::imdecode(jpeg, cv::IMREAD_UNCHANGED).empty());
  }
}

TEST(Thumbnail, NoImageGivesNone) { EXPECT_TRUE(thumbnail_jpeg({}).empty()); }

}  // namespace
}  // namespace coslam::thumbnail_test
