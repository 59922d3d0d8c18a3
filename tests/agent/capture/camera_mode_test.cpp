// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/camera_mode.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::camera_mode_test {
namespace {

using ::testing::HasSubstr;

TEST(CameraMode, AsTheCameraHasIt) {
  const CameraMode mode = parse_camera_mode("v4l2:2");
  EXPECT_EQ(mode.device, "2");
  EXPECT_EQ(mode.width_px, 0);
  EXPECT_EQ(mode.rate_hz, 0);
  EXPECT_EQ(mode.format, "");
  EXPECT_EQ(parse_camera_mode("v4l2:/dev/video0").device, "/dev/video0");
}

TEST(CameraMode, SizeRateAndFormatInAnyOrder) {
  const CameraMode mode = parse_camera_mode("v4l2:/dev/v4l/by-id/usb-cam?format=MJPG&size=1280x720&fps=29.97");
  EXPECT_EQ(mode.device, "/dev/v4l/by-id/usb-cam");
  EXPECT_EQ(mode.width_px, 1280);
  EXPECT_EQ(mode.height_px, 720);
  EXPECT_EQ(mode.rate_hz, 29.97);
  EXPECT_EQ(mode.format, "MJPG");
}

TEST(CameraMode, SaysWhatIsWrong) {
  const auto said = [](const char* uri) { return test::error_of<UserError>([&] { parse_camera_mode(uri); }); };
  EXPECT_THAT(said("v4l2:"), HasSubstr("which camera is not said"));
  EXPECT_THAT(said("v4l2:0?size=1280"), HasSubstr("'1280' is no size"));
  EXPECT_THAT(said("v4l2:0?size=0x720"), HasSubstr("'0x720' is no size"));
  EXPECT_THAT(said("v4l2:0?size=x"), HasSubstr("'x' is no size"));
  EXPECT_THAT(said("v4l2:0?fps=fast"), HasSubstr("'fast' is no rate"));
  EXPECT_THAT(said("v4l2:0?format=JPEG2000"), HasSubstr("no format of four letters"));
  EXPECT_THAT(said("v4l2:0?width=640"), HasSubstr("the key 'width' is not known"));
  EXPECT_THAT(said("v4l2:0?"), testing::IsEmpty());
}

}  // namespace
}  // namespace coslam::camera_mode_test
