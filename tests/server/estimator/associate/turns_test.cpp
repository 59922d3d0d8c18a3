// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/turns.h"

#include <gmock/gmock.h>

#include <map>

namespace coslam::turns_test {
namespace {

FrameSet set_of(std::size_t cameras) {
  FrameSet set;
  for (std::size_t i = 0; i < cameras; ++i) set.frames.emplace_back().camera = CameraId(static_cast<std::uint16_t>(i));
  return set;
}

TEST(Turns, FewCamerasLookAlways) {
  for (std::uint32_t round = 0; round < 3; ++round) {
    EXPECT_THAT(cameras_in_turn(set_of(8), round), testing::SizeIs(8));
  }
  EXPECT_THAT(cameras_in_turn({}, 1), testing::IsEmpty());
}

TEST(Turns, OfManyAsManyLookAtOnceAndEachAsOften) {
  for (const std::size_t cameras : {9U, 12U, 17U, 64U}) {
    const std::uint32_t rounds = (static_cast<std::uint32_t>(cameras) + 7) / 8;
    std::map<CameraId, int> looks;
    for (std::uint32_t round = 100; round < 100 + rounds; ++round) {
      const auto now = cameras_in_turn(set_of(cameras), round);
      EXPECT_LE(now.size(), 8U);
      for (const CameraId c : now) ++looks[c];
    }
    EXPECT_EQ(looks.size(), cameras);
    for (const auto& [camera, n] : looks) EXPECT_EQ(n, 1) << camera.value;
  }
}

}  // namespace
}  // namespace coslam::turns_test
