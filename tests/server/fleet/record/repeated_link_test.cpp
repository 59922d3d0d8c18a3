// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/record/repeated_link.h"

#include <gmock/gmock.h>

#include <map>
#include <set>
#include <type_traits>
#include <variant>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/wire_values.h"

namespace coslam::repeated_link_test {
namespace {

using std::chrono::milliseconds;

constexpr TimeNs kFirst_ns = 5'000'000'000, kStep_ns = 50'000'000;
constexpr std::uint32_t kFrames = 10;
constexpr milliseconds kPatience{60'000};

// A recording of two agents, ten frames of each in half a second.
class RepeatedLinkTest : public ::testing::Test {
 protected:
  RepeatedLinkTest() : file_(temp_ / "run.rec") {
    RecordWriter writer(file_);
    const auto write = [&](const Record& record) { EXPECT_EQ(writer.write(record), 0); };
    write(encode_head({"1", RunId(1), 7'000, 9'000, nlohmann::ordered_json::object()}));
    for (const char* agent : {"left", "right"}) write(encode_event(values_.hello(agent, run_of(agent)), 10));
    for (std::uint32_t i = 0; i < kFrames; ++i) {
      for (const char* agent : {"left", "right"}) {
        TrackFrame frame = values_.frame(agent, run_of(agent), i, 5);
        frame.capture_ns = kFirst_ns + i * kStep_ns;
        write(encode_event(JoinedFrame{frame, {}, {}, {}}, 20 + i));
      }
    }
    write(encode_event(AgentGone{"left", run_of("left")}, 90));
    write({RecordType::kEnd, 100, {}});
  }
  static RunId run_of(const std::string& agent) { return RunId(agent == "left" ? 0x11 : 0x22); }

  static std::string agent_of(const ServerEvent& event) {
    return std::visit(
        [](const auto& e) {
          if constexpr (std::is_same_v<std::decay_t<decltype(e)>, JoinedFrame>) {
            return e.frame.agent;
          } else {
            return e.agent;
          }
        },
        event);
  }
  // Frames until the end, in the order in which they come.
  static std::vector<TrackFrame> frames_of(RepeatedLink& link) {
    std::vector<TrackFrame> out;
    while (const auto event = link.next_event(kPatience)) {
      if (const auto* joined = std::get_if<JoinedFrame>(&*event)) out.push_back(joined->frame);
    }
    return out;
  }

  test::TempFolder temp_;
  test::WireValues values_{1};
  std::filesystem::path file_;
};

TEST_F(RepeatedLinkTest, OnceItIsTheRecording) {
  RepeatedLink link(file_, {});
  EXPECT_EQ(link.head().server_run, RunId(1));
  const std::vector<TrackFrame> frames = frames_of(link);
  ASSERT_EQ(frames.size(), 2 * kFrames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].agent, i % 2 == 0 ? "left" : "right");
    EXPECT_EQ(frames[i].agent_run, run_of(frames[i].agent));
    EXPECT_EQ(frames[i].capture_ns, static_cast<TimeNs>(i / 2) * kStep_ns) << "played time begins at 0";
  }
  EXPECT_TRUE(link.over());
  EXPECT_FALSE(link.next_event(kPatience));
  EXPECT_EQ(link.now_ns(), (kFrames - 1) * kStep_ns);
  EXPECT_EQ(link.monotonic_ns() - link.now_ns(), link.head().monotonic_ns);
  EXPECT_EQ(link.utc_ns() - link.now_ns(), link.head().utc_ns);
}

TEST_F(RepeatedLinkTest, EachTimeThereAreNewRunsOfTheSameNamesInLaterTime) {
  RepeatedLink link(file_, {.times = 3, .pause_s = 1});
  std::map<std::string, std::set<RunId>> runs;
  TimeNs last_ns = 0;
  const std::vector<TrackFrame> frames = frames_of(link);
  ASSERT_EQ(frames.size(), 3 * 2 * kFrames);
  for (const TrackFrame& frame : frames) {
    runs[frame.agent].insert(frame.agent_run);
    EXPECT_GE(frame.capture_ns, last_ns);
    last_ns = frame.capture_ns;
  }
  ASSERT_EQ(runs.size(), 2U);
  std::set<RunId> all;
  for (const auto& [agent, of_agent] : runs) {
    EXPECT_EQ(of_agent.size(), 3U) << agent;
    all.insert(of_agent.begin(), of_agent.end());
  }
  EXPECT_EQ(all.size(), 6U) << "no two agents share a run";
  EXPECT_FALSE(all.contains(RunId()));
  const TimeNs pause_ns = frames[2 * kFrames].capture_ns - frames[2 * kFrames - 1].capture_ns;
  EXPECT_GE(pause_ns, 1'000'000'000);
  EXPECT_LE(pause_ns, 1'100'000'000) << "rounded up to whole frames";
  EXPECT_LE(last_ns, link.length_ns());
}

TEST_F(RepeatedLinkTest, FleetsPlaySideBySideAndEachHasItsNames) {
  RepeatedLink link(file_, {.times = 2, .fleets = 3, .pause_s = 0});
  std::map<std::string, std::vector<TimeNs>> captured;
  TimeNs last_ns = 0;
  while (const auto event = link.next_event(kPatience)) {
    if (const auto* joined = std::get_if<JoinedFrame>(&*event)) {
      captured[joined->frame.agent].push_back(joined->frame.capture_ns);
      EXPECT_GE(joined->frame.capture_ns, last_ns) << "in the order of played time";
      last_ns = joined->frame.capture_ns;
      EXPECT_EQ(link.now_ns(), last_ns);
    }
  }
  ASSERT_EQ(captured.size(), 6U);
  for (const char* name : {"left", "right", "left-2", "right-2", "left-3", "right-3"}) {
    ASSERT_TRUE(captured.contains(name)) << name;
    EXPECT_EQ(captured[name].size(), 2 * kFrames) << name;
    EXPECT_TRUE(std::ranges::is_sorted(captured[name])) << name;
    EXPECT_EQ(captured[name][0] % 100'000'000, 0) << "images of all fleets are of one instant";
  }
  EXPECT_LT(captured["left"][0], captured["left-2"][0]) << "each starts at another part";
  EXPECT_LT(captured["left-2"][0], captured["left-3"][0]);
  EXPECT_LE(last_ns, link.length_ns());
}

TEST_F(RepeatedLinkTest, HellosAndFarewellsAreOfTheRunOfTheirFrames) {
  RepeatedLink link(file_, {.times = 2, .fleets = 2});
  std::map<std::string, RunId> at_work;
  int gone = 0;
  while (const auto event = link.next_event(kPatience)) {
    if (const auto* hello = std::get_if<Hello>(&*event)) at_work[hello->agent] = hello->agent_run;
    if (const auto* joined = std::get_if<JoinedFrame>(&*event)) {
      EXPECT_EQ(at_work.at(joined->frame.agent), joined->frame.agent_run);
    }
    if (const auto* end = std::get_if<AgentGone>(&*event)) {
      EXPECT_EQ(at_work.at(end->agent), end->agent_run);
      ++gone;
    }
  }
  EXPECT_EQ(gone, 4);
}

TEST_F(RepeatedLinkTest, PlayedTimePassesOnlyWhileTheLoopWaits) {
  RepeatedLink link(file_, {.times = 2, .pause_s = 1});
  int events = 0;
  while (link.next_event(milliseconds(0))) ++events;
  EXPECT_EQ(events, 4) << "two hellos and two frames are due at once";
  EXPECT_EQ(link.now_ns(), 0);
  EXPECT_FALSE(link.over());
  EXPECT_FALSE(link.next_event(milliseconds(20)));
  EXPECT_EQ(link.now_ns(), 20'000'000) << "the next frame is due in 50 ms";
  EXPECT_TRUE(link.next_event(milliseconds(40)));
  EXPECT_EQ(link.now_ns(), kStep_ns) << "it did not wait any longer";
}

TEST_F(RepeatedLinkTest, EveryReplayIsTheSameHoweverItIsWaitedFor) {
  RepeatedLink one(file_, {.times = 2, .fleets = 2}), other(file_, {.times = 2, .fleets = 2});
  while (const auto a = one.next_event(kPatience)) {
    std::optional<ServerEvent> b;
    while (!b && !other.over()) b = other.next_event(milliseconds(7));
    ASSERT_TRUE(b);
    EXPECT_EQ(a->index(), b->index());
    EXPECT_EQ(agent_of(*a), agent_of(*b));
    EXPECT_EQ(one.now_ns(), other.now_ns());
  }
  EXPECT_TRUE(other.over());
}

TEST_F(RepeatedLinkTest, ARecordingWithoutFramesIsRefused) {
  const auto file = temp_ / "empty.rec";
  {
    RecordWriter writer(file);
    EXPECT_EQ(writer.write(encode_head({"1", RunId(1), 5, 6, nlohmann::ordered_json::object()})), 0);
    EXPECT_EQ(writer.write(encode_event(values_.hello("left", RunId(1)), 10)), 0);
  }
  EXPECT_EQ(test::error_of<UserError>([&] { RepeatedLink(file, {}); }), file.string() + " has no frame");
  EXPECT_NE(test::error_of<UserError>([&] { RepeatedLink(temp_ / "none.rec", {}); }), "");
}

}  // namespace
}  // namespace coslam::repeated_link_test
