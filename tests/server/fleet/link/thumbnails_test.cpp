// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/thumbnails.h"

#include <gtest/gtest.h>

#include <chrono>

namespace coslam::thumbnails_test {
namespace {

using namespace std::chrono_literals;

const Thumbnail kImage{"a", RunId(1), 7, {1, 2, 3}};

TEST(Thumbnails, AreAskedForOnceASecondAtMost) {
  Thumbnails thumbnails;
  Instant now{};
  int asked = 0;
  for (int i = 0; i < 100; ++i, now += 100ms) asked += thumbnails.look("a", now) ? 1 : 0;
  EXPECT_EQ(asked, 10);
  EXPECT_TRUE(thumbnails.look("b", now)) << "each agent has its own time";
}

TEST(Thumbnails, WhatNobodyAskedForIsNotKept) {
  Thumbnails thumbnails;
  thumbnails.add(kImage, {});
  EXPECT_FALSE(thumbnails.newest("a", {}));
  thumbnails.look("a", {});
  EXPECT_FALSE(thumbnails.newest("a", {}));
  thumbnails.add(kImage, {});
  EXPECT_EQ(thumbnails.newest("a", {})->jpeg, kImage.jpeg);
}

TEST(Thumbnails, AreForgottenAfterFiveSeconds) {
  Thumbnails thumbnails;
  Instant now{};
  thumbnails.look("a", now);
  thumbnails.add(kImage, now);
  now += 4s;
  thumbnails.look("a", now);
  EXPECT_TRUE(thumbnails.newest("a", now));
  now += 2s;
  thumbnails.tick(now);
  EXPECT_FALSE(thumbnails.newest("a", now)) << "somebody still looks, but the image is old";
  now += 4s;
  thumbnails.tick(now);
  thumbnails.add(kImage, now);
  EXPECT_FALSE(thumbnails.newest("a", now)) << "nobody looks any more";
}

}  // namespace
}  // namespace coslam::thumbnails_test
