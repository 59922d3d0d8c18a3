// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/sync/frame_set_sync.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace coslam::frame_set_sync_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr CameraId kA(0), kB(1), kC(2);
constexpr TimeNs kMs = 1'000'000;
constexpr TimeNs kPeriod = 33 * kMs;

CameraFrame frame_of(CameraId camera, TimeNs capture_ns) {
  CameraFrame cf{camera, {}, {}, {}};
  cf.frame.capture_ns = capture_ns;
  return cf;
}

// A sync of cameras at 30 Hz and a clock that the test moves.
class SyncTest : public testing::Test {
 protected:
  void add(std::initializer_list<CameraId> cameras, bool lockstep = false) {
    for (const CameraId c : cameras) sync_.add(c, 1000.0 / 33, lockstep);
  }
  bool push(CameraId camera, TimeNs capture_ns) { return sync_.push(frame_of(camera, capture_ns), now_ns_); }
  // "0@100 1@103" for a set of camera 0 captured at 100 ms and camera 1 at 103 ms; empty for none.
  std::string pop() {
    const std::optional<FrameSet> set = sync_.pop(now_ns_);
    if (!set) return "";
    EXPECT_EQ(set->id, SetId(next_set_++));
    std::string text;
    for (const CameraFrame& f : set->frames) {
      text +=
          (text.empty() ? "" : " ") + std::to_string(f.camera.value) + "@" + std::to_string(f.frame.capture_ns / kMs);
    }
    t_ns_ = set->t_ns;
    return text;
  }
  void wait_ms(int ms) { now_ns_ += ms * kMs; }

  FrameSetSync sync_{SyncConfig{.deadline_s = 0.12}};  // 0.55 of a period, 90 frames
  TimeNs now_ns_ = 1'000'000 * kMs, t_ns_ = 0;
  std::uint32_t next_set_ = 0;
};

TEST_F(SyncTest, NothingComesFromNothing) {
  EXPECT_EQ(pop(), "");
  add({kA});
  EXPECT_EQ(pop(), "");
  EXPECT_THAT(sync_.blocking(), ElementsAre(kA));
  EXPECT_FALSE(push(kB, 0)) << "not a member";
}

TEST_F(SyncTest, WaitsForAllAndSaysForWhom) {
  add({kA, kB, kC});
  EXPECT_TRUE(push(kC, 100 * kMs));
  EXPECT_EQ(pop(), "");
  EXPECT_THAT(sync_.blocking(), ElementsAre(kA, kB));
  push(kA, 101 * kMs);
  EXPECT_THAT(sync_.blocking(), ElementsAre(kB));
  EXPECT_EQ(pop(), "");
  push(kB, 99 * kMs);
  EXPECT_THAT(sync_.blocking(), IsEmpty());
  EXPECT_EQ(pop(), "0@101 1@99 2@100");
  EXPECT_EQ(t_ns_, 100 * kMs) << "the middle of its frames";
  EXPECT_EQ(pop(), "");
}

// Its clock or its link is half a second behind: the others wait for it by so much, and the deadline more.
TEST_F(SyncTest, WaitsForOneThatIsAlwaysLate) {
  add({kA, kB});
  int pairs = 0, late = 0;
  for (int i = 0; i < 200; ++i) {
    now_ns_ = i * kPeriod + 1'000'000 * kMs;
    push(kA, i * kPeriod);
    if (i >= 15) late += !push(kB, (i - 15) * kPeriod);
    for (std::string s = pop(); !s.empty(); s = pop()) pairs += s.find(' ') != std::string::npos;
  }
  EXPECT_LE(late, 15) << "until it is known how late it is";
  EXPECT_GE(pairs, 165);
}

TEST_F(SyncTest, DoesNotWaitForOneThatIsSecondsLate) {
  add({kA, kB});
  int sets = 0;
  for (int i = 0; i < 200; ++i) {
    now_ns_ = i * kPeriod + 1'000'000 * kMs;
    push(kA, i * kPeriod);
    if (i >= 100) push(kB, (i - 100) * kPeriod);
    for (std::string s = pop(); !s.empty(); s = pop()) ++sets;
  }
  EXPECT_GE(sets, 160);
}

TEST_F(SyncTest, FramesOfOneInstantOnly) {
  add({kA, kB});
  push(kA, 0);
  push(kB, 20 * kMs);  // the tolerance is 18 ms
  EXPECT_EQ(pop(), "0@0");
  EXPECT_EQ(pop(), "");  // the next of camera 0 may belong to it
  push(kA, 33 * kMs);
  EXPECT_EQ(pop(), "0@33 1@20");
}

TEST_F(SyncTest, HalfAFrameApart) {
  add({kA, kB});
  for (int i = 0; i < 50; ++i) {
    push(kA, i * kPeriod);
    push(kB, i * kPeriod + kPeriod / 2);
    EXPECT_EQ(pop(), "0@" + std::to_string(33 * i) + " 1@" + std::to_string(33 * i + 16));
    EXPECT_EQ(pop(), "");
  }
}

TEST_F(SyncTest, AJitteringCameraStaysWithTheOthers) {
  add({kA, kB});
  std::mt19937 random(1);
  std::uniform_int_distribution<int> jitter(-5, 5);
  int pairs = 0;
  for (int i = 1; i < 200; ++i) {
    push(kA, i * kPeriod);
    push(kB, i * kPeriod + jitter(random) * kMs);
    pairs += pop().find(' ') != std::string::npos;
  }
  EXPECT_EQ(pairs, 199);
}

TEST_F(SyncTest, AFasterCameraGetsSetsOfItsOwn) {
  sync_.add(kA, 60, false);
  sync_.add(kB, 30, false);
  std::vector<std::string> sets;
  for (int i = 0; i < 4; ++i) {
    push(kA, i * 16 * kMs);
    if (i % 2 == 0) push(kB, i * 16 * kMs);
    for (std::string s = pop(); !s.empty(); s = pop()) sets.push_back(s);
  }
  wait_ms(200);
  for (std::string s = pop(); !s.empty(); s = pop()) sets.push_back(s);
  EXPECT_THAT(sets, ElementsAre("0@0 1@0", "0@16", "0@32 1@32", "0@48"));
}

// Said to run at 30 Hz, both take 10 images a second, 35 ms apart.
TEST_F(SyncTest, HowOftenFramesComeIsMeasured) {
  add({kA, kB});
  std::vector<std::string> sets;
  for (int i = 0; i < 20; ++i) {
    push(kA, i * 100 * kMs);
    push(kB, (i * 100 + 35) * kMs);
    for (std::string s = pop(); !s.empty(); s = pop()) sets.push_back(s);
  }
  ASSERT_GE(sets.size(), 10U);
  for (std::size_t i = 12; i < sets.size(); ++i) EXPECT_THAT(sets[i], testing::HasSubstr(" ")) << i;
}

// A tenth of the frames of a camera at 30 Hz is nearer to those of another than to its own neighbours.
TEST_F(SyncTest, FramesJoinTheNearestOfAFasterCamera) {
  sync_.add(kA, 30, true);
  sync_.add(kB, 30, true);  // in truth 10
  sync_.add(kC, 10, true);  // likewise, 45 ms after that
  std::map<std::string, int> joined;
  for (int i = 0; i < 300; ++i) {
    push(kA, i * kPeriod);
    if (i % 3 == 0) push(kB, (i * 33 + 10) * kMs);
    if (i % 3 == 0) push(kC, (i * 33 + 55) * kMs);
    for (std::string s = pop(); !s.empty(); s = pop()) {
      if (i > 30)
        ++joined[std::string{s.find("1@") == std::string::npos ? '-' : 'b',
                             s.find("2@") == std::string::npos ? '-' : 'c'}];
    }
  }
  EXPECT_EQ(joined["bc"], 0) << "45 ms apart";
  EXPECT_GT(joined["b-"], 80);
  EXPECT_GT(joined["-c"], 80);
}

TEST_F(SyncTest, LostFramesAreNoOtherRate) {
  add({kA, kB}, true);
  std::mt19937 random(3);
  std::bernoulli_distribution lost(0.3);
  int pairs = 0, both = 0;
  for (int i = 0; i < 300; ++i) {
    const bool a = !lost(random), b = !lost(random);
    if (a) push(kA, i * kPeriod);
    if (b) push(kB, i * kPeriod + 3 * kMs);
    both += a && b;
    for (std::string s = pop(); !s.empty(); s = pop()) pairs += s.find(' ') != std::string::npos;
  }
  EXPECT_NEAR(pairs, both, 3);
}

TEST_F(SyncTest, AfterTheDeadlineTheOthersGoOn) {
  add({kA, kB});
  push(kA, 0);
  wait_ms(119);
  EXPECT_EQ(pop(), "");
  wait_ms(2);
  EXPECT_EQ(pop(), "0@0");
  EXPECT_THAT(sync_.blocking(), ElementsAre(kA, kB));
}

TEST_F(SyncTest, ALateFrameIsRefusedAndCounted) {
  add({kA, kB});
  push(kA, 1000 * kMs);
  wait_ms(200);
  ASSERT_EQ(pop(), "0@1000");
  EXPECT_FALSE(push(kB, 967 * kMs));
  EXPECT_EQ(sync_.late(), 1U);
  push(kA, 1033 * kMs);
  EXPECT_TRUE(push(kB, 1033 * kMs));
  EXPECT_EQ(pop(), "0@1033 1@1033");
}

TEST_F(SyncTest, AFrameOfTheInstantThatJustPassedGetsASetOfItsOwn) {
  add({kA, kB});
  push(kA, 1000 * kMs);
  wait_ms(200);
  ASSERT_EQ(pop(), "0@1000");
  EXPECT_TRUE(push(kB, 1000 * kMs));
  push(kA, 1033 * kMs);
  EXPECT_EQ(pop(), "1@1000");
}

TEST_F(SyncTest, SetsComeInTheOrderOfTime) {
  add({kA, kB, kC});
  std::mt19937 random(7);
  std::uniform_int_distribution<int> which(0, 2);
  int next[3] = {0, 0, 0};
  TimeNs last_ns = -1;
  int frames = 0;
  for (int i = 0; i < 3000; ++i) {
    const int c = which(random);
    push(CameraId(static_cast<std::uint16_t>(c)), next[c]++ * kPeriod + 3 * c * kMs);
    wait_ms(1);
    while (true) {
      const std::string s = pop();
      if (s.empty()) break;
      EXPECT_GT(t_ns_, last_ns);
      last_ns = t_ns_;
      frames += 1 + static_cast<int>(std::count(s.begin(), s.end(), ' '));
    }
  }
  EXPECT_GT(frames, 1000);
}

TEST_F(SyncTest, ASilentAgentIsNotWaitedForUntilItSpeaks) {
  add({kA, kB});
  sync_.set_silent(kB);
  push(kA, 0);
  EXPECT_THAT(sync_.blocking(), IsEmpty());
  EXPECT_EQ(pop(), "0@0");
  push(kB, 33 * kMs);
  EXPECT_EQ(pop(), "") << "it is waited with again";
  EXPECT_THAT(sync_.blocking(), ElementsAre(kA));
  push(kA, 33 * kMs);
  EXPECT_EQ(pop(), "0@33 1@33");
}

TEST_F(SyncTest, AFinishedAgentsFramesAreStillUsed) {
  add({kA, kB}, true);
  push(kB, 0);
  push(kB, 33 * kMs);
  sync_.finish(kB);
  push(kA, 0);
  EXPECT_EQ(pop(), "0@0 1@0");
  push(kA, 33 * kMs);
  EXPECT_EQ(pop(), "0@33 1@33");
  push(kA, 66 * kMs);
  EXPECT_EQ(pop(), "0@66") << "and then it is not waited for, in lock-step either";
  EXPECT_THAT(sync_.blocking(), ElementsAre(kA));
}

TEST_F(SyncTest, LockstepWaitsForEver) {
  add({kA, kB}, true);
  push(kA, 0);
  for (int hour = 0; hour < 24; ++hour) {
    wait_ms(3'600'000);
    ASSERT_EQ(pop(), "");
  }
  EXPECT_THAT(sync_.blocking(), ElementsAre(kB));
  push(kB, 0);
  EXPECT_EQ(pop(), "0@0 1@0");
}

TEST_F(SyncTest, OneInLockstepHoldsTheLiveOnes) {
  add({kA});
  add({kB}, true);
  push(kA, 0);
  wait_ms(1000);
  EXPECT_EQ(pop(), "");
}

TEST_F(SyncTest, QueuesAreBoundedButNotInLockstep) {
  add({kA, kB});
  for (int i = 0; i < 200; ++i) push(kA, i * kPeriod);
  EXPECT_EQ(sync_.overflowed(), 110U);
  push(kB, 110 * kPeriod);
  EXPECT_EQ(pop(), "0@" + std::to_string(110 * 33) + " 1@" + std::to_string(110 * 33)) << "the oldest went";
  FrameSetSync lockstep{SyncConfig{.deadline_s = 0.12}};
  lockstep.add(kA, 30, true);
  for (int i = 0; i < 200; ++i) lockstep.push(frame_of(kA, i * kPeriod), 0);
  EXPECT_EQ(lockstep.overflowed(), 0U);
}

TEST_F(SyncTest, AnAgentThatRestartsBeginsAnew) {
  add({kA, kB});
  push(kB, 0);
  sync_.finish(kB);
  add({kB});  // back, as another run
  EXPECT_THAT(sync_.blocking(), ElementsAre(kA, kB)) << "what the old run had sent is gone";
  push(kA, 33 * kMs);
  push(kB, 33 * kMs);
  EXPECT_EQ(pop(), "0@33 1@33");
}

}  // namespace
}  // namespace coslam::frame_set_sync_test
