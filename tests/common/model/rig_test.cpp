// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/model/rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.h"

namespace coslam::rig_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Rig, TextGivesBackTheSame) {
  const RigCamera camera{"right", "left", {so3_exp({0.01, -0.2, 0.003}), {-0.537151, 1e-9, 0.25}}};
  const RigCamera back = parse_rig_camera(text_of(camera));
  EXPECT_EQ(back.camera, "right");
  EXPECT_EQ(back.first, "left");
  EXPECT_EQ(back.cam_from_first.translation, camera.cam_from_first.translation);
  EXPECT_LT(back.cam_from_first.rotation.angularDistance(camera.cam_from_first.rotation), 1e-15);
}

TEST(Rig, SaysWhatIsWrong) {
  const auto parse = [](const char* text) { return [text] { parse_rig_camera(text); }; };
  EXPECT_THAT(parse("right"), ThrowsMessage<UserError>(HasSubstr("is not CAMERA FIRST")));
  EXPECT_THAT(parse("right left 1 0 0 0 0 0 one"), ThrowsMessage<UserError>(HasSubstr("is not CAMERA FIRST")));
  EXPECT_THAT(parse("right left 1 0 0"), ThrowsMessage<UserError>(HasSubstr("seven numbers")));
  EXPECT_THAT(parse("right left 1 0 0 0 0 0 0.5"), ThrowsMessage<UserError>(HasSubstr("quaternion of length 1")));
  EXPECT_THAT(parse("right left 0 0 0 0 0 0 1"), ThrowsMessage<UserError>(HasSubstr("at one place")));
  EXPECT_THAT(parse("left left 1 0 0 0 0 0 1"), ThrowsMessage<UserError>(HasSubstr("'left' twice")));
}

}  // namespace
}  // namespace coslam::rig_test
