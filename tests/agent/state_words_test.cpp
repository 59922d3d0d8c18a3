// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/state_words.h"

#include <gmock/gmock.h>

#include <vector>

namespace coslam::state_words_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class StateWordsTest : public testing::Test {
 protected:
  void server(bool alive, std::chrono::milliseconds time) {
    pass(time, [&] { return words_.server(alive, now_); });
  }
  void pose(PoseState state, std::chrono::milliseconds time) {
    pass(time, [&] { return words_.pose(state, now_); });
  }
  void link(bool carries_all, std::chrono::milliseconds time) {
    pass(time, [&] { return words_.link(carries_all, now_); });
  }

  std::vector<std::string> said_;

 private:
  template <class Note>
  void pass(std::chrono::milliseconds time, const Note& note) {
    for (const Instant end = now_ + time; now_ < end; now_ += 50ms) {
      if (const auto word = note()) said_.push_back(*word);
    }
  }
  StateWords words_;
  Instant now_{};
};

TEST_F(StateWordsTest, SaysOnceThatTheServerIsSilentAndBack) {
  server(false, 2s);
  server(true, 1s);
  EXPECT_THAT(said_, IsEmpty()) << "it was waited for, which others say";
  server(false, 3s);
  server(true, 1s);
  EXPECT_THAT(said_, ElementsAre("the map server is silent; going on alone", "the map server is back after 3.0 s"));
}

TEST_F(StateWordsTest, SaysWhenTheLinkCarriesLessThanItDid) {
  link(false, 2s);
  link(true, 1s);
  EXPECT_THAT(said_, IsEmpty()) << "agents begin with few frames";
  link(false, 3s);
  link(true, 1s);
  EXPECT_THAT(said_, ElementsAre("the link does not carry all frames; sending fewer",
                                 "the link carries all frames again after 3.0 s"));
}

TEST_F(StateWordsTest, SaysWhenThePoseIsThereLostAndFound) {
  pose(PoseState::kNone, 1s);
  pose(PoseState::kTracked, 1s);
  pose(PoseState::kLost, 1200ms);
  pose(PoseState::kTracked, 1s);
  EXPECT_THAT(said_, ElementsAre("has a pose in the map", "lost: no pose in the map",
                                 "found again: has a pose in the map after 1.2 s"));
}

TEST_F(StateWordsTest, WhatIsSoonOverIsNoWordWorth) {
  server(true, 1s);
  pose(PoseState::kTracked, 1s);
  said_.clear();
  for (int i = 0; i < 5; ++i) {
    server(false, 400ms);
    server(true, 100ms);
    pose(PoseState::kLost, 400ms);
    pose(PoseState::kTracked, 100ms);
  }
  EXPECT_THAT(said_, IsEmpty());
}

TEST(StateWords, SaysOnceThatAShutterIsFound) {
  StateWords words;
  EXPECT_FALSE(words.readout(0));
  const auto word = words.readout(0.0257);
  ASSERT_TRUE(word);
  EXPECT_THAT(*word, testing::HasSubstr("26 ms"));
  EXPECT_FALSE(words.readout(0.0265));
  EXPECT_TRUE(words.readout(0.017)) << "it is another one by now";
  EXPECT_TRUE(words.readout(0));
  EXPECT_FALSE(words.readout(0));
}

TEST(StateWords, SaysWhenTheSizeChangesThatIsTracked) {
  StateWords words;
  EXPECT_FALSE(words.working_width(1280));
  EXPECT_FALSE(words.working_width(1280));
  const auto smaller = words.working_width(640);
  ASSERT_TRUE(smaller);
  EXPECT_THAT(*smaller, testing::HasSubstr("640 pixels instead of 1280"));
  EXPECT_FALSE(words.working_width(640));
  EXPECT_TRUE(words.working_width(1280));
}

TEST_F(StateWordsTest, SaysWhyImagesAreNotToBeBelievedAndThatTheyAreAgain) {
  StateWords words;
  EXPECT_FALSE(words.images(ImageFault::kNone));
  EXPECT_EQ(words.images(ImageFault::kRepeated), "its images are not to be believed: they are the same bit by bit");
  EXPECT_FALSE(words.images(ImageFault::kRepeated));
  EXPECT_EQ(words.images(ImageFault::kMissing), "its images are not to be believed: none come");
  EXPECT_EQ(words.images(ImageFault::kNone), "its images are to be believed again");
}

TEST_F(StateWordsTest, SaysOnceThatImagesAreTakenInTurnAtSeveralSettings) {
  StateWords words;
  EXPECT_FALSE(words.alternating(false));
  EXPECT_THAT(words.alternating(true), testing::Optional(testing::HasSubstr("take all at one")));
  EXPECT_FALSE(words.alternating(true));
}

TEST_F(StateWordsTest, SaysOnceThatManyImagesAreRepeats) {
  StateWords words;
  EXPECT_FALSE(words.repeating(9, 9)) << "a few";
  EXPECT_FALSE(words.repeating(10, 200)) << "now and then";
  EXPECT_THAT(words.repeating(20, 60), testing::Optional(testing::HasSubstr("left out")));
  EXPECT_FALSE(words.repeating(40, 120));
}

TEST_F(StateWordsTest, APatternThatStaysOnce) {
  StateWords words;
  EXPECT_FALSE(words.fixed_pattern(false));
  EXPECT_THAT(words.fixed_pattern(true), testing::Optional(testing::HasSubstr("switch the emitter off")));
  EXPECT_FALSE(words.fixed_pattern(true));
}

TEST_F(StateWordsTest, SaysHowMuchOfThePictureMovesWithTheCamera) {
  StateWords words;
  EXPECT_FALSE(words.own_body(0));
  EXPECT_THAT(words.own_body(0.3).value_or(""), testing::StartsWith("30 % of its picture moves with the camera"));
  EXPECT_FALSE(words.own_body(0.33));
  EXPECT_THAT(words.own_body(0.4).value_or(""), testing::StartsWith("40 %"));
}

TEST_F(StateWordsTest, SaysOnceThatTheTimeOfDayWasSet) {
  StateWords words;
  EXPECT_FALSE(words.clock(0));
  EXPECT_EQ(words.clock(-3'600'000'000'000), "the time of day was set back by 3600.000 s; stamps go on without a jump");
  EXPECT_FALSE(words.clock(-3'600'000'001'000));
  EXPECT_EQ(words.clock(1'000'000'000), "the time of day was set forward by 3601.000 s; stamps go on without a jump");
}

}  // namespace
}  // namespace coslam::state_words_test
