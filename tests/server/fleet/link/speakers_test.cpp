// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/speakers.h"

#include <gtest/gtest.h>

namespace coslam::speakers_test {
namespace {

// The last octet tells the writers of a process from each other.
WriterId writer(std::uint8_t process, std::uint8_t number) {
  WriterId id;
  id.guid.front() = process;
  id.guid.back() = number;
  return id;
}

TEST(SpeakersTest, NobodyElseSpeaksForARun) {
  Speakers speakers;
  EXPECT_TRUE(speakers.may_say(RunId(1), writer(1, 2), false)) << "ahead of its hello";
  EXPECT_TRUE(speakers.may_say(RunId(1), writer(1, 1), true));
  EXPECT_TRUE(speakers.may_say(RunId(1), writer(1, 2), false));
  EXPECT_FALSE(speakers.may_say(RunId(1), writer(2, 2), false));
  EXPECT_FALSE(speakers.may_say(RunId(1), writer(2, 1), true));
  EXPECT_TRUE(speakers.may_say(RunId(2), writer(2, 1), true)) << "it may speak for itself";
}

TEST(SpeakersTest, OneRunAProcess) {
  Speakers speakers;
  EXPECT_TRUE(speakers.may_say(RunId(1), writer(1, 1), true));
  EXPECT_FALSE(speakers.may_say(RunId(2), writer(1, 1), true));
  EXPECT_FALSE(speakers.may_say(RunId(2), writer(1, 3), true)) << "with a further writer";
  EXPECT_TRUE(speakers.may_say(RunId(2), writer(2, 1), true)) << "the run was not taken";
}

TEST(SpeakersTest, WhoIsGoneMayComeBack) {
  Speakers speakers;
  EXPECT_TRUE(speakers.may_say(RunId(1), writer(1, 1), true));
  speakers.note_gone(writer(1, 1));
  EXPECT_TRUE(speakers.may_say(RunId(1), writer(1, 1), true));
}

}  // namespace
}  // namespace coslam::speakers_test
