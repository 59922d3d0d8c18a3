// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <opencv2/videoio.hpp>

#include "agent/capture/source.h"
#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam {
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

TEST_F(Video, PlaysAtTheContainersRate) {
  const auto source = open_source(file_, kOptions);
  for (int i = 0; i < 8; ++i) {
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
  const auto first = source->next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->frame, FrameId(0));
  EXPECT_EQ(first->capture_ns, 0);
  EXPECT_NEAR(first->grey.at<uchar>(20, 20), 40, 3);
  EXPECT_TRUE(source->skip());
  EXPECT_FALSE(source->skip());
  options.start_s = 9;
  EXPECT_THAT(test::error_of<UserError>([&] { open_source(file_, options); }), HasSubstr("no readable frame"));
}

TEST_F(Video, WrongSize) {
  SourceOptions options = kOptions;
  options.width_px = 640;
  EXPECT_THAT(test::error_of<UserError>([&] { open_source(file_, options); }), HasSubstr("clip.avi is 64x48 pixels"));
}

}  // namespace
}  // namespace coslam
