// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/mask.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::mask_test {
namespace {

using testing::HasSubstr;

// Of 40x30 pixels, whose lower third is a hood.
class MaskTest : public testing::Test {
 protected:
  static cv::Mat painted(int type, const cv::Scalar& above, const cv::Scalar& hood) {
    cv::Mat out(30, 40, type, above);
    out.rowRange(20, 30).setTo(hood);
    return out;
  }
  std::string file(const cv::Mat& image) const {
    const std::string name = (folder_ / "mask.png").string();
    cv::imwrite(name, image);
    return name;
  }
  cv::Mat read(const cv::Mat& image) const { return read_mask(file(image)); }
  std::string error(const cv::Mat& image) const {
    return test::error_of<UserError>([&] { read(image); });
  }
  static bool equal(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0; }
  const test::TempFolder folder_;
  const cv::Mat wanted_ = painted(CV_8UC1, 255, 0);
};

TEST_F(MaskTest, IsReadByWhatIsBrightInIt) {
  EXPECT_TRUE(equal(read(wanted_), wanted_));
  EXPECT_TRUE(equal(read(painted(CV_8UC1, 1, 0)), wanted_));
  EXPECT_TRUE(equal(read(painted(CV_16UC1, 1, 0)), wanted_));
  EXPECT_TRUE(equal(read(painted(CV_16UC1, 65535, 0)), wanted_));
  EXPECT_TRUE(equal(read(painted(CV_8UC1, 128, 10)), wanted_));
  EXPECT_TRUE(equal(read(painted(CV_8UC3, {255, 255, 255}, {0, 0, 255})), wanted_));
}

TEST_F(MaskTest, BlackPaintOnATransparentSheetLeavesOutWhatIsPainted) {
  EXPECT_TRUE(equal(read(painted(CV_8UC4, {0, 0, 0, 0}, {0, 0, 0, 255})), wanted_));
  EXPECT_TRUE(equal(read(painted(CV_8UC4, {255, 255, 255, 0}, {0, 0, 0, 255})), wanted_));
}

TEST_F(MaskTest, AHoleInAWhiteSheetLeavesOutTheHole) {
  EXPECT_TRUE(equal(read(painted(CV_8UC4, {255, 255, 255, 255}, {255, 255, 255, 0})), wanted_));
  EXPECT_TRUE(equal(read(painted(CV_8UC4, {255, 255, 255, 255}, {0, 0, 0, 0})), wanted_));
}

TEST_F(MaskTest, AnOpaquePictureIsReadByItsColours) {
  EXPECT_TRUE(equal(read(painted(CV_8UC4, {255, 255, 255, 255}, {0, 0, 0, 255})), wanted_));
}

TEST_F(MaskTest, TransparencyThatMayMeanEitherIsRefused) {
  cv::Mat photo = painted(CV_8UC4, {200, 200, 200, 255}, {0, 0, 0, 0});
  photo.rowRange(0, 10).setTo(cv::Scalar(20, 20, 20, 255));
  EXPECT_THAT(error(photo), HasSubstr("mask.png has transparent parts beside dark and bright ones: save it without"));
}

TEST_F(MaskTest, PaintOnAPhotoIsRefused) {
  cv::Mat photo(300, 400, CV_8UC1);
  cv::RNG(1).fill(photo, cv::RNG::UNIFORM, 60, 200);
  photo.rowRange(200, 300).setTo(0);
  EXPECT_THAT(error(photo), HasSubstr("mask.png is a picture of many grey levels: it is to be black where"));
  cv::Mat soft = photo;
  soft.setTo(255);
  soft.rowRange(200, 300).setTo(0);
  cv::GaussianBlur(soft, soft, {}, 2);
  EXPECT_EQ(cv::countNonZero(read(soft)), 200 * 400);
}

TEST_F(MaskTest, OneThatLeavesOutEverythingIsRefused) {
  EXPECT_THAT(error(painted(CV_8UC1, 0, 0)), HasSubstr("mask.png leaves out the whole image: it is to be white"));
}

TEST_F(MaskTest, WhatItLeavesOutIsSaid) {
  const MaskWord word = word_of("m.png", wanted_);
  EXPECT_EQ(word.text, "the mask m.png leaves out 33 % of the image");
  EXPECT_FALSE(word.doubtful);
  const MaskWord inverted = word_of("m.png", ~wanted_), white = word_of("m.png", wanted_ | ~wanted_);
  EXPECT_THAT(inverted.text, HasSubstr("leaves out 67 % of the image: perhaps it is inverted"));
  EXPECT_TRUE(inverted.doubtful);
  EXPECT_THAT(white.text, HasSubstr("leaves out nothing of the image: perhaps it is inverted"));
  EXPECT_TRUE(white.doubtful);
}

}  // namespace
}  // namespace coslam::mask_test
