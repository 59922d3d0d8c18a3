// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Topics of a node made with another DDS, as a source hears them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <functional>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "agent/capture/camera_of.h"
#include "agent/capture/source.h"
#include "common/base/error.h"
#include "tests/interop/cyclone_here.h"
#include "tests/interop/ros2_images.h"
#include "tests/support/child_process.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_domain.h"

namespace coslam::ros2_source_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Ros2Source : public testing::Test {
 protected:
  Ros2Source() { test::keep_cyclone_here(); }

  std::unique_ptr<test::ChildProcess> camera(std::vector<std::string> settings) const {
    settings.insert(settings.begin(), {CYCLONE_CAMERA, "domain=" + std::to_string(domain_.number())});
    return std::make_unique<test::ChildProcess>(std::move(settings));
  }
  std::string name(const std::string& topic) const {
    return "ros2:" + topic + "?domain=" + std::to_string(domain_.number());
  }
  std::string error(const std::string& topic) const {
    return test::error_of<UserError>([&] { open_source(name(topic), {}); });
  }
  // So many images of camera, each as it was sent.
  void expect_images(ImageSource& source, int count, int width, int height, const std::string& encoding) const {
    for (int i = 0; i < count; ++i) {
      const auto image = source.next();
      ASSERT_TRUE(image);
      const long number = test::number_of(image->capture_ns);
      ASSERT_GE(number, 0) << image->capture_ns;
      EXPECT_TRUE(test::same(image->grey, test::grey_image(number, width, height, encoding))) << "image " << number;
      EXPECT_EQ(image->frame, FrameId(static_cast<std::uint32_t>(i)));
    }
    EXPECT_EQ(source.undated(), 0u);
  }

  const test::TestDomain domain_;
};

TEST_F(Ros2Source, ImagesOfEachEncodingAreThoseThatWereSent) {
  const auto mono = camera({"topic=/mono"});
  const auto colour = camera({"topic=/colour", "encoding=bgr8", "step=192", "reliable=0"});
  const auto yuv = camera({"topic=/yuv", "encoding=yuyv", "step=128", "reliable=0"});
  const SourceOptions options{.width_px = 64, .height_px = 48};
  const auto source = open_source(name("/mono"), options);
  EXPECT_TRUE(source->live());
  EXPECT_FALSE(source->peek_ns());
  expect_images(*source, 10, 64, 48, "mono8");
  expect_images(*open_source(name("/colour"), options), 10, 64, 48, "bgr8");
  expect_images(*open_source(name("/yuv"), options), 10, 64, 48, "yuyv");
}

TEST_F(Ros2Source, CompressedImagesAreDecoded) {
  const test::TempFolder folder;
  const cv::Mat grey = test::grey_image(0, 64, 48, "mono8");
  cv::imwrite((folder / "a.png").string(), grey);
  const auto node = camera({"topic=/image/compressed", "type=file", "file=" + (folder / "a.png").string()});
  const auto source = open_source(name("/image/compressed"), {});
  const auto image = source->next();
  ASSERT_TRUE(image);
  EXPECT_TRUE(test::same(image->grey, grey));
  EXPECT_GE(test::number_of(image->capture_ns), 0);
}

TEST_F(Ros2Source, ALargeImageArrivesWhole) {
  const auto node = camera({"width=1920", "height=1080", "step=5760", "encoding=bgr8", "rate=5"});
  expect_images(*open_source(name("/image"), {}), 5, 1920, 1080, "bgr8");
}

TEST_F(Ros2Source, ANodeThatIsKilledAndComesBackIsHeardAgain) {
  auto node = camera({});
  const auto source = open_source(name("/image"), {});
  expect_images(*source, 5, 64, 48, "mono8");
  node = nullptr;
  node = camera({"first=1000000"});
  std::optional<Image> image;
  do {
    image = source->next();
    ASSERT_TRUE(image);
  } while (test::number_of(image->capture_ns) < 1'000'000);
  EXPECT_TRUE(test::same(image->grey, test::grey_image(test::number_of(image->capture_ns), 64, 48, "mono8")));
}

TEST_F(Ros2Source, ANodeThatComesBackMayOfferLess) {
  auto node = camera({"reliable=1"});
  const auto source = open_source(name("/image"), {});
  node = nullptr;
  node = camera({"first=1000000", "reliable=0"});
  std::optional<Image> image;
  do {
    image = source->next();
    ASSERT_TRUE(image);
  } while (test::number_of(image->capture_ns) < 1'000'000);
}

TEST_F(Ros2Source, ImagesWithoutAStampCountAsOfWhenTheyCome) {
  const auto node = camera({"stamped=0"});
  const auto source = open_source(name("/image"), {});
  const auto first = source->next(), second = source->next();
  ASSERT_TRUE(first && second);
  EXPECT_GT(first->capture_ns, test::kFirstStamp_ns);
  EXPECT_GT(second->capture_ns, first->capture_ns);
}

TEST_F(Ros2Source, StopEndsTheWaitForANodeThatIsGone) {
  auto node = camera({});
  const auto source = open_source(name("/image"), {});
  node = nullptr;
  std::jthread stopper([&] { source->stop(); });
  while (source->next()) {
  }
}

TEST_F(Ros2Source, AnotherSizeThanTheCalibrationsIsRefused) {
  const auto node = camera({});
  EXPECT_THAT(test::error_of<UserError>([&] { open_source(name("/image"), {.width_px = 640, .height_px = 480}); }),
              HasSubstr("is 64x48 pixels"));
}

TEST_F(Ros2Source, WhatIsNotThereIsNamedBesideWhatIs) {
  const std::string domain = std::to_string(domain_.number());
  EXPECT_THAT(error("/image"), HasSubstr("no node was seen in ROS domain " + domain + " at 127.0.0.1"));
  const auto node = camera({"topic=/left/image_raw"}), points = camera({"topic=/points", "type=points"});
  EXPECT_THAT(error("/right/image_raw"), HasSubstr("there is no topic /right/image_raw in ROS domain " + domain +
                                                   "; Image topics seen: /left/image_raw (sensor_msgs/msg/Image)"));
  EXPECT_THAT(error("/points"), AllOf(HasSubstr("topic /points in ROS domain " + domain +
                                                " is of type sensor_msgs/msg/PointCloud2, but " +
                                                "sensor_msgs/msg/Image or sensor_msgs/msg/CompressedImage is read"),
                                      HasSubstr("/left/image_raw (sensor_msgs/msg/Image)")));
}

TEST_F(Ros2Source, WhatCannotBeReadIsNamed) {
  const auto odd = camera({"topic=/odd", "encoding=64FC1"});
  EXPECT_THAT(error("/odd"), HasSubstr("no image came that can be read; its encoding is 64FC1, as of depth or heat"));
  const auto owner = camera({"topic=/owned", "exclusive=1"});
  EXPECT_THAT(error("/owned"),
              HasSubstr("who writes topic /owned offers another QoS than is read here: its ownership"));
}

TEST_F(Ros2Source, ACalibrationIsThatOfItsFirstMessage) {
  const auto node = camera({"topic=/camera_info", "type=info"}), images = camera({});
  const FoundCamera found = camera_of(name("/image"), name("/camera_info"), {});
  EXPECT_EQ(found.guess, "");
  EXPECT_EQ(found.camera.width_px, 64);
  EXPECT_EQ(found.camera.height_px, 48);
  EXPECT_EQ(found.camera.fx, 500.5);
  EXPECT_EQ(found.camera.fy, 501.75);
  EXPECT_EQ(found.camera.cx, 31.25);
  EXPECT_EQ(found.camera.cy, 23.5);
  EXPECT_EQ(found.camera.distortion, DistortionModel::kRadTan);
  EXPECT_EQ(found.camera.coefficients[0], -0.25);
  EXPECT_EQ(found.camera.coefficients[4], 0.015625);
}

}  // namespace
}  // namespace coslam::ros2_source_test
