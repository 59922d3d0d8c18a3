// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/peer_paths.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace coslam::peer_paths_test {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kCable = 1, kRadio = 2;  // the same numbers at both ends
constexpr std::uint16_t kPort = 7411;
constexpr ParticipantKey kLow{1}, kHigh{2};

// Two participants with two ways between them, in simulated time.
class TwoWays : public testing::Test {
 protected:
  struct End {
    ParticipantKey own, other;
    PeerPaths paths;
    std::map<std::uint32_t, int> sent;
    int received = 0;
  };
  TwoWays() {
    for (End* e : {&low_, &high_}) {
      e->paths.set_own(e->own);
      e->paths.set_peer(e->other, {{kCable, kPort}, {kRadio, kPort}});
    }
  }
  void send(End* from, End* to, const std::set<std::uint32_t>& open) {
    bool arrived = false;
    for (const std::uint32_t way : {kCable, kRadio}) {
      if (!from->paths.goes({way, kPort}, now_)) continue;
      ++from->sent[way];
      if (!open.contains(way)) continue;
      to->paths.heard(from->own, way, now_);
      arrived = true;
    }
    to->received += arrived ? 1 : 0;
  }
  // 20 datagrams a second each way; tells of how many arrived none.
  struct Lost {
    int to_high, to_low;
  };
  Lost talk(std::chrono::seconds duration, const std::set<std::uint32_t>& open_to_high,
            const std::set<std::uint32_t>& open_to_low) {
    for (End* e : {&low_, &high_}) {
      e->sent.clear();
      e->received = 0;
    }
    const int count = static_cast<int>(duration / 50ms);
    for (int i = 0; i < count; ++i, now_ += 50ms) {
      send(&low_, &high_, open_to_high);
      send(&high_, &low_, open_to_low);
    }
    return {count - high_.received, count - low_.received};
  }
  Lost talk(std::chrono::seconds duration, const std::set<std::uint32_t>& open) { return talk(duration, open, open); }

  PeerPaths::TimePoint now_{1h};
  End low_{kLow, kHigh, {}, {}}, high_{kHigh, kLow, {}, {}};
};

TEST_F(TwoWays, EachByteGoesOnceAndBothOnTheSameWay) {
  talk(2s, {kCable, kRadio});
  const Lost lost = talk(10s, {kCable, kRadio});
  EXPECT_EQ(lost.to_high + lost.to_low, 0);
  EXPECT_EQ(low_.sent[kCable] + low_.sent[kRadio], 200);
  EXPECT_EQ(low_.sent[kCable], high_.sent[kCable]);
}

TEST_F(TwoWays, TheOtherWayIsTakenWithinASecondWhenOneFails) {
  talk(2s, {kCable, kRadio});
  const std::uint32_t used = low_.sent[kCable] > low_.sent[kRadio] ? kCable : kRadio;
  const std::uint32_t left = kCable + kRadio - used;
  const Lost lost = talk(5s, {left});
  EXPECT_LE(lost.to_high, 21);
  EXPECT_LE(lost.to_low, 21);
  talk(5s, {left});
  EXPECT_EQ(low_.sent[left], 100);
  EXPECT_EQ(low_.sent[used] + high_.sent[used], 0);
}

TEST_F(TwoWays, AWayOnWhichTheOtherOneDoesNotHearIsNotKept) {
  for (const std::uint32_t blocked : {kCable, kRadio}) {
    const std::uint32_t open = kCable + kRadio - blocked;
    talk(10s, {open}, {kCable, kRadio});
    EXPECT_LE(talk(10s, {open}, {kCable, kRadio}).to_high, 25) << blocked;
    talk(40s, {kCable, kRadio});
    talk(10s, {kCable, kRadio}, {open});
    EXPECT_LE(talk(10s, {kCable, kRadio}, {open}).to_low, 25) << blocked;
    talk(40s, {kCable, kRadio});
  }
}

TEST_F(TwoWays, WhoeverIsNotHeardIsCalledOnAllWays) {
  EXPECT_TRUE(low_.paths.goes({kCable, kPort}, now_));
  EXPECT_TRUE(low_.paths.goes({kRadio, kPort}, now_));
  EXPECT_TRUE(low_.paths.goes({77, kPort}, now_)) << "nobody's";
}

TEST_F(TwoWays, WhoHasGoneIsForgotten) {
  talk(2s, {kCable});
  EXPECT_FALSE(low_.paths.goes({kRadio, kPort}, now_));
  low_.paths.forget(kHigh);
  EXPECT_TRUE(low_.paths.goes({kRadio, kPort}, now_));
}

}  // namespace
}  // namespace coslam::peer_paths_test
