// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/video/plug_in.h"

#include <gmock/gmock.h>

#include "common/video/video_codecs.h"

namespace coslam {
namespace {

TEST(PlugIn, OneThatIsNotInstalledIsNamed) {
  const PlugIn none = load_plug_in("coslam-nothing", "dreams are read by it");
  EXPECT_EQ(none.object, nullptr);
  EXPECT_EQ(none.why_not,
            "dreams are read by it, which comes with the package coslam-nothing, and that is not installed here");
}

TEST(PlugIn, ThatOfVideosIsLoadedOnce) {
  ASSERT_NE(video_codecs_if_any(), nullptr) << why_no_video_codecs();
  EXPECT_EQ(video_codecs_if_any(), &video_codecs());
  EXPECT_THAT(why_no_video_codecs(), testing::IsEmpty());
}

}  // namespace
}  // namespace coslam
