// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/v4l2_camera.h"

#include <gmock/gmock.h>
#include <linux/videodev2.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <opencv2/imgcodecs.hpp>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam {
namespace {

using testing::HasSubstr;

// A driver that has some formats, all of 64x48, and pictures that a test gives it.
class FakeDriver final : public CameraDriver {
 public:
  std::vector<std::uint32_t> formats{V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG};
  std::uint32_t set = V4L2_PIX_FMT_YUYV;
  double rate_hz = 30;
  bool busy = false;
  bool* streams = nullptr;

  struct Shot {
    std::vector<std::uint8_t> octets;
    bool damaged = false;
  };
  std::deque<Shot> shots;
  bool unplugged = false;

  int control(unsigned long request, void* argument) override {
    if (request == VIDIOC_G_FMT || request == VIDIOC_S_FMT) return format(request, static_cast<v4l2_format*>(argument));
    if (request == VIDIOC_ENUM_FMT) return list(static_cast<v4l2_fmtdesc*>(argument));
    if (request == VIDIOC_S_PARM) {
      static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe = {1, static_cast<std::uint32_t>(rate_hz)};
    }
    if (request == VIDIOC_STREAMOFF && streams != nullptr) *streams = false;
    if (request == VIDIOC_STREAMON && streams != nullptr) *streams = true;
    auto* buffer = static_cast<v4l2_buffer*>(argument);
    if (request == VIDIOC_QUERYBUF) {
      buffer->length = kRoom;
      buffer->m.offset = buffer->index * kRoom;
    }
    if (request == VIDIOC_QBUF) free_.push_back(buffer->index);
    return request == VIDIOC_DQBUF ? fill(buffer) : 0;
  }
  std::span<const std::uint8_t> map(std::size_t octets, std::int64_t offset) override {
    return std::span(memory_).subspan(static_cast<std::size_t>(offset), octets);
  }
  bool wait(std::chrono::milliseconds) override { return unplugged || !shots.empty(); }

 private:
  static constexpr std::uint32_t kRoom = 64 * 48 * 2;
  int format(unsigned long request, v4l2_format* f) {
    v4l2_pix_format& p = f->fmt.pix;
    if (request == VIDIOC_S_FMT && busy) return EBUSY;
    if (request == VIDIOC_S_FMT && std::ranges::find(formats, p.pixelformat) != formats.end()) set = p.pixelformat;
    p.pixelformat = set;
    p.width = 64;
    p.height = 48;
    p.bytesperline = set == V4L2_PIX_FMT_MJPEG ? 0 : set == V4L2_PIX_FMT_YUYV ? 128 : 64;
    return 0;
  }
  int list(v4l2_fmtdesc* f) const {
    if (f->index >= formats.size()) return EINVAL;
    f->pixelformat = formats[f->index];
    return 0;
  }
  int fill(v4l2_buffer* buffer) {
    if (unplugged) return ENODEV;
    if (shots.empty() || free_.empty()) return EAGAIN;
    const Shot shot = shots.front();
    shots.pop_front();
    buffer->index = free_.front();
    free_.pop_front();
    buffer->bytesused = static_cast<std::uint32_t>(shot.octets.size());
    buffer->flags = shot.damaged ? V4L2_BUF_FLAG_ERROR : 0;
    std::ranges::copy(shot.octets, memory_.begin() + buffer->index * kRoom);
    return 0;
  }
  std::vector<std::uint8_t> memory_ = std::vector<std::uint8_t>(8 * kRoom);
  std::deque<std::uint32_t> free_;
};

class V4l2 : public testing::Test {
 protected:
  V4l2() : made_(std::make_unique<FakeDriver>()), driver_(*made_) {}
  std::unique_ptr<V4l2Camera> start(const CameraMode& mode = {}) {
    return V4l2Camera::start(std::move(made_), mode, "v4l2:0", &why_);
  }
  static FakeDriver::Shot grey_shot(std::uint8_t level, std::size_t octets_per_pixel) {
    return {std::vector<std::uint8_t>(64 * 48 * octets_per_pixel, level)};
  }
  std::unique_ptr<FakeDriver> made_;
  FakeDriver& driver_;
  std::atomic<bool> stopped_ = false;
  std::string why_;
};

TEST_F(V4l2, PicturesAreTheLumaOfTheNewest) {
  bool streams = false;
  driver_.streams = &streams;
  auto camera = start();
  ASSERT_TRUE(camera) << why_;
  EXPECT_TRUE(streams);
  for (int i = 0; i < 10; ++i) {
    for (const int level : {10, 20, 30 + i}) driver_.shots.push_back(grey_shot(static_cast<std::uint8_t>(level), 2));
    const auto grey = camera->read(stopped_);
    ASSERT_TRUE(grey);
    ASSERT_EQ(grey->size(), cv::Size(64, 48));
    EXPECT_EQ(grey->at<std::uint8_t>(20, 20), 30 + i);
  }
  camera.reset();
  EXPECT_FALSE(streams);
}

TEST_F(V4l2, OneThatGivesJpegIsDecoded) {
  const auto camera = start({.device = "0", .format = "MJPG"});
  ASSERT_TRUE(camera) << why_;
  FakeDriver::Shot shot;
  cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC1, cv::Scalar(77)), shot.octets);
  driver_.shots.push_back(shot);
  const auto grey = camera->read(stopped_);
  ASSERT_TRUE(grey);
  ASSERT_EQ(grey->size(), cv::Size(64, 48));
  EXPECT_EQ(grey->at<std::uint8_t>(20, 20), 77);
}

TEST_F(V4l2, AFormatThatIsNotReadGivesWayToOneThatIs) {
  driver_.formats = {V4L2_PIX_FMT_H264, V4L2_PIX_FMT_GREY};
  driver_.set = V4L2_PIX_FMT_H264;
  const auto camera = start();
  ASSERT_TRUE(camera) << why_;
  driver_.shots.push_back(grey_shot(99, 1));
  const auto grey = camera->read(stopped_);
  ASSERT_TRUE(grey);
  EXPECT_EQ(grey->at<std::uint8_t>(20, 20), 99);
}

TEST_F(V4l2, WithoutOneItSaysSo) {
  driver_.formats = {V4L2_PIX_FMT_H264};
  driver_.set = V4L2_PIX_FMT_H264;
  EXPECT_FALSE(start());
  EXPECT_THAT(why_, HasSubstr("no format that is read here, but H264"));
}

TEST_F(V4l2, AnotherModeThanItHasIsAnError) {
  EXPECT_THAT(test::error_of<UserError>([&] { start({.device = "0", .format = "GREY"}); }),
              HasSubstr("v4l2:0: the camera does not give the format GREY"));
  made_ = std::make_unique<FakeDriver>();
  EXPECT_THAT(test::error_of<UserError>([&] { start({.device = "0", .width_px = 640, .height_px = 480}); }),
              HasSubstr("v4l2:0: the camera gives 64x48 instead"));
}

TEST_F(V4l2, OneThatIsInUseSaysSo) {
  driver_.busy = true;
  EXPECT_FALSE(start());
  EXPECT_EQ(why_, std::strerror(EBUSY));
}

TEST_F(V4l2, ADamagedPictureIsEmptyAndALostCameraIsNone) {
  const auto camera = start();
  ASSERT_TRUE(camera) << why_;
  driver_.shots.push_back({std::vector<std::uint8_t>(64), true});
  auto grey = camera->read(stopped_);
  ASSERT_TRUE(grey);
  EXPECT_TRUE(grey->empty());
  driver_.shots.push_back({std::vector<std::uint8_t>(64), false});
  grey = camera->read(stopped_);
  ASSERT_TRUE(grey);
  EXPECT_TRUE(grey->empty()) << "it is short";
  driver_.unplugged = true;
  EXPECT_FALSE(camera->read(stopped_));
}

TEST_F(V4l2, StopEndsTheWait) {
  const auto camera = start();
  ASSERT_TRUE(camera) << why_;
  stopped_ = true;
  EXPECT_FALSE(camera->read(stopped_));
}

}  // namespace
}  // namespace coslam
