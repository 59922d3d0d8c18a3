// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/reply_parts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "common/wire/codec.h"
#include "common/wire/participant.h"
#include "tests/support/wire_equal.h"
#include "tests/support/wire_values.h"

namespace coslam::reply_parts_test {
namespace {

using test::WireValues;
using testing::SizeIs;

class ReplyPartsTest : public testing::Test {
 protected:
  DescriptorReply reply(std::uint32_t frame, int tracks) {
    return values_.descriptors(values_.frame("cam0", RunId(1), frame, 0), tracks);
  }
  WireValues values_{1};
  PartJoiner<DescriptorReply> joiner_{3};
};

TEST_F(ReplyPartsTest, EachFitsADatagram) {
  const auto frame = values_.frame("a-name-of-thirty-two-characters-", RunId(1), 5, 0);
  const auto descriptors = in_parts(values_.descriptors(frame, 33));
  ASSERT_THAT(descriptors, SizeIs(3));
  EXPECT_THAT(descriptors.back().tracks, SizeIs(1));
  for (const auto& part : descriptors) EXPECT_LE(sample_bytes(encode(part)), 1192U) << "with a seal, too";
  for (const auto& part : in_parts(values_.patches(frame, 33))) EXPECT_LE(sample_bytes(encode(part)), 1192U);
}

TEST_F(ReplyPartsTest, ComeTogetherInAnyOrder) {
  const DescriptorReply whole = reply(5, 100);
  std::vector<DescriptorReply> parts = in_parts(whole);
  std::ranges::shuffle(parts, std::mt19937(3));
  for (const DescriptorReply& part : parts) {
    EXPECT_FALSE(joiner_.has(FrameId(5)));
    EXPECT_FALSE(joiner_.take(FrameId(5)));
    EXPECT_EQ(joiner_.add(part), std::nullopt);
  }
  ASSERT_TRUE(joiner_.has(FrameId(5)));
  EXPECT_EQ(joiner_.oldest_complete(), FrameId(5));
  const auto taken = joiner_.take(FrameId(5));
  ASSERT_TRUE(taken);
  test::expect_same(*taken, whole);
  EXPECT_FALSE(joiner_.has(FrameId(5)));
}

TEST_F(ReplyPartsTest, AnEmptyReplyIsOnePart) {
  const auto parts = in_parts(reply(5, 0));
  ASSERT_THAT(parts, SizeIs(1));
  EXPECT_EQ(joiner_.add(parts[0]), std::nullopt);
  EXPECT_TRUE(joiner_.take(FrameId(5)));
}

TEST_F(ReplyPartsTest, WhatDoesNotFitIsTurnedDown) {
  auto parts = in_parts(reply(5, 40));
  EXPECT_EQ(joiner_.add(parts[0]), std::nullopt);
  EXPECT_EQ(joiner_.add(parts[0]), Rejection::kDuplicate);
  parts[1].part.count = 4;
  EXPECT_EQ(joiner_.add(parts[1]), Rejection::kSizeMismatch);
}

TEST_F(ReplyPartsTest, TracksThatDoNotAscendOverAllMakeNoReply) {
  auto parts = in_parts(reply(5, 32));
  std::swap(parts[0].part, parts[1].part);
  for (const auto& part : parts) EXPECT_EQ(joiner_.add(part), std::nullopt);
  EXPECT_FALSE(joiner_.take(FrameId(5)));
  EXPECT_FALSE(joiner_.has(FrameId(5))) << "forgotten";
}

// A reply one part of which never comes does not stay for ever.
TEST_F(ReplyPartsTest, TheOldestMakesRoom) {
  EXPECT_EQ(joiner_.add(in_parts(reply(1, 20))[0]), std::nullopt);
  EXPECT_EQ(joiner_.add(in_parts(reply(2, 5))[0]), std::nullopt);
  EXPECT_EQ(joiner_.add(in_parts(reply(3, 5))[0]), std::nullopt);
  EXPECT_EQ(joiner_.add(in_parts(reply(4, 5))[0]), Rejection::kOverflow);
  EXPECT_EQ(joiner_.add(in_parts(reply(1, 20))[1]), Rejection::kOverflow) << "as if it were new; 2 goes";
  EXPECT_FALSE(joiner_.has(FrameId(1)));
  EXPECT_EQ(joiner_.oldest_complete(), FrameId(3));
}

}  // namespace
}  // namespace coslam::reply_parts_test
