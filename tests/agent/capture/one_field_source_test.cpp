// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "agent/capture/source.h"
#include "tests/agent/capture/interlaced.h"
#include "tests/support/temp_folder.h"

namespace coslam::one_field_source_test {
namespace {

class OneFieldSourceTest : public testing::Test {
 protected:
  static constexpr int kImages = 12;
  std::unique_ptr<ImageSource> opened(const std::function<cv::Mat(int)>& image) {
    for (int i = 0; i < kImages; ++i) cv::imwrite((folder_ / (std::to_string(i) + ".png")).string(), image(i));
    return open_source(folder_.path().string(), {});
  }
  test::TempFolder folder_;
};

TEST_F(OneFieldSourceTest, InterlacedImagesAreOfOneTimeFromTheFirstOn) {
  for (const Fields order : {Fields::kUpperFirst, Fields::kLowerFirst}) {
    const auto source = opened([&](int i) { return test::interlaced(i, order); });
    for (int i = 0; i < kImages; ++i) {
      const auto image = source->next();
      ASSERT_TRUE(image);
      const cv::Mat whole = test::view(test::place_px(i), i);
      EXPECT_LT(cv::norm(image->grey, whole, cv::NORM_L1) / static_cast<double>(whole.total()), 2) << i;
    }
    EXPECT_FALSE(source->next());
  }
}

TEST_F(OneFieldSourceTest, WholeFramesStayAsTheyAre) {
  const auto source = opened([](int i) { return test::view(test::place_px(i), i); });
  for (int i = 0; i < kImages; ++i) {
    const auto image = source->next();
    ASSERT_TRUE(image);
    EXPECT_EQ(cv::norm(image->grey, test::view(test::place_px(i), i), cv::NORM_INF), 0) << i;
  }
}

TEST_F(OneFieldSourceTest, ImagesThatAreReadAheadArePassedOverToo) {
  const auto source = opened([](int i) { return test::view(test::place_px(i), i); });
  EXPECT_EQ(source->next()->frame.value, 0);
  EXPECT_EQ(source->peek_ns(), to_ns(1 / 30.0));
  EXPECT_TRUE(source->skip());
  EXPECT_EQ(source->next()->frame.value, 2);
  int left = 0;
  while (source->skip()) ++left;
  EXPECT_EQ(left, kImages - 3);
  EXPECT_FALSE(source->peek_ns());
}

}  // namespace
}  // namespace coslam::one_field_source_test
