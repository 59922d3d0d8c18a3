// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/record/recorded_link.h"

#include <gmock/gmock.h>

#include <map>
#include <random>

#include "common/base/error.h"
#include "deploy/coslam/run/inline_link.h"
#include "server/app/server_loop.h"
#include "server/fleet/record/recording_link.h"
#include "tests/support/result_files.h"
#include "tests/support/sim_run.h"
#include "tests/support/temp_folder.h"
#include "tests/support/wire_values.h"

namespace coslam::recorded_link_test {
namespace {

using namespace std::chrono_literals;
using test::expect_same_result;
using test::SimAgent;
using test::SimWorld;

constexpr RunId kServer(1);
constexpr TimeNs kPeriod_ns = 33'333'333;
constexpr int kFrames = 70;

class Replay : public ::testing::Test {
 protected:
  // Two agents in a simulated room, in lock-step, recorded.
  void run_recorded(const std::string& out) {
    const SimWorld world({.moving_points = 50});
    InlineLink link(kServer);
    RecordingLink recording(link.server(), recording_, {.server_run = kServer, .configuration = {{"agents", 2}}});
    ServerLoop loop(recording, kServer, config(out));
    std::vector<SimAgent> agents;
    std::vector<std::unique_ptr<AgentLink>> ends;
    for (const auto& path : test::paths_side_by_side(2)) {
      agents.emplace_back(world, path, test::TrackingConfig(), names_[agents.size()], RunId(10 + agents.size()));
      ends.push_back(link.connect(agents.back().tracker().hello()));
    }
    for (int i = 0; i < kFrames; ++i) {
      for (std::size_t a = 0; a < agents.size(); ++a) {
        for (MapPatch& patch : ends[a]->take_patches()) agents[a].give(std::move(patch));
        CameraFrame f = agents[a].step(CameraId(), kPeriod_ns * i);
        ends[a]->send(std::move(f.frame), f.patches, f.descriptors);
      }
      EXPECT_TRUE(loop.poll(0ms));
    }
    test::WireValues values(1);
    for (std::size_t a = 0; a < ends.size(); ++a)
      ends[a]->send(values.agent_status(names_[a], RunId(10 + a), AgentState::kFinished));
    EXPECT_FALSE(loop.poll(0ms));
    recording.end();
    loop.finish({});
    EXPECT_GT(loop.map_server().counts().refinements, 0);
    report_ = loop.report();
  }

  void replay(const std::filesystem::path& file, const std::string& out, bool agents_end = true) {
    RecordedLink link(file);
    ServerLoopConfig replayed = config(out);
    if (!agents_end) replayed.expected_agents.clear();
    replayed.clock = {[&link] { return link.monotonic_ns(); }, [&link] { return link.utc_ns(); }};
    ServerLoop loop(link, link.head().server_run, replayed);
    while (!link.over() && loop.poll(20ms)) {
    }
    loop.finish({});
    report_ = loop.report();
  }

  // The same frames from agents in real time, one of which is always 40 ms late and falls silent at the end.
  std::filesystem::path live_recording() {
    const auto file = temp_ / "live.rec";
    Recording recorded(recording_);
    std::multimap<TimeNs, ServerEvent> events;
    while (auto timed = recorded.next()) {
      if (auto* hello = std::get_if<Hello>(&timed->event)) {
        hello->pacing = Pacing::kLive;
        events.emplace(0, std::move(*hello));
      }
      if (auto* frame = std::get_if<JoinedFrame>(&timed->event)) {
        const bool late = frame->frame.agent == names_[1];
        if (late && frame->frame.frame.value > 60) continue;
        events.emplace(50'000'000 + frame->frame.capture_ns + (late ? 40'000'000 : 0), std::move(*frame));
      }
    }
    RecordWriter writer(file);
    EXPECT_EQ(writer.write(encode_head(recorded.head())), 0);
    for (const auto& [t_ns, event] : events) EXPECT_EQ(writer.write(encode_event(event, t_ns)), 0);
    EXPECT_EQ(writer.write({RecordType::kEnd, 4'000'000'000, {}}), 0);
    return file;
  }

  ServerLoopConfig config(const std::string& out) const {
    return {.expected_agents = names_, .result = {.folder = temp_ / out, .runs = {}}, .refine_in_thread = false};
  }

  test::TempFolder temp_;
  const std::filesystem::path recording_ = temp_ / "a.rec";
  const std::vector<std::string> names_{"cam0", "cam1"};
  nlohmann::ordered_json report_;
};

TEST_F(Replay, OfALockstepRunIsThatRun) {
  run_recorded("run");
  EXPECT_EQ(report_["frame_sets"], kFrames);
  replay(recording_, "first");
  EXPECT_EQ(report_["frame_sets"], kFrames);
  expect_same_result(temp_ / "run", temp_ / "first");
  replay(recording_, "second");
  expect_same_result(temp_ / "first", temp_ / "second");
}

TEST_F(Replay, OfALiveRunIsTheSameEveryTime) {
  run_recorded("run");
  const auto live = live_recording();
  replay(live, "first", false);
  EXPECT_EQ(report_["frame_sets"], kFrames) << "those of one agent alone when the time for the other is over";
  EXPECT_GT(report_["server"]["points"]["static"], 100);
  EXPECT_EQ(report_["frames_out_of_time"], 0);
  EXPECT_EQ(report_["frame_sets_left_out"], 0);
  replay(live, "second", false);
  expect_same_result(temp_ / "first", temp_ / "second");
}

TEST_F(Replay, OfOneThatWasCutOffGoesAsFarAsItReads) {
  run_recorded("run");
  std::filesystem::resize_file(recording_, std::filesystem::file_size(recording_) / 2);
  EXPECT_TRUE(check_recording(recording_).cut_off);
  replay(recording_, "half");
  EXPECT_GT(report_["frame_sets"], 5);
  EXPECT_LT(report_["frame_sets"], kFrames);
}

// With checksums that are right: it is replayed, or refused with a sentence.
TEST_F(Replay, OfWhatAStrangerMade) {
  constexpr int kRecordings = 12, kRecords = 80;
  run_recorded("run");
  std::mt19937 random(12345);
  int replayed = 0;
  for (int i = 0; i < kRecordings; ++i) {
    const auto file = temp_ / (std::to_string(i) + ".rec");
    RecordReader reader(recording_);
    RecordWriter writer(file);
    for (int k = 0; k < kRecords; ++k) {
      auto record = reader.next();
      ASSERT_TRUE(record);
      if (k > 0 && random() % 20 == 0) {
        record->payload[random() % record->payload.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
      }
      EXPECT_EQ(writer.write(*record), 0);
    }
    const std::string refused = test::error_of<UserError>([&] { check_recording(file); });
    if (!refused.empty()) continue;
    replay(file, "result" + std::to_string(i), i % 2 == 0);
    ++replayed;
  }
  EXPECT_GT(replayed, 0);
  EXPECT_LT(replayed, kRecordings);
}

class RecordedLinkTest : public ::testing::Test {
 protected:
  RecordedLinkTest() {
    RecordWriter writer(file_);
    test::WireValues values(1);
    writer.write(encode_head({"1", kServer, 1'000, 2'000, nlohmann::ordered_json::object()}));
    writer.write(encode_event(values.hello("cam0", RunId(1)), 5'000'000));
    writer.write(encode_event(AgentSilent{"cam0", RunId(1)}, 5'000'000));
    writer.write(encode_event(AgentGone{"cam0", RunId(1)}, 30'000'000));
    writer.write({RecordType::kEnd, 60'000'000, {}});
  }
  test::TempFolder temp_;
  const std::filesystem::path file_ = temp_ / "a.rec";
};

TEST_F(RecordedLinkTest, TimeIsThatOfTheRecording) {
  RecordedLink link(file_);
  EXPECT_FALSE(link.next_event(0ms)) << "not yet";
  EXPECT_EQ(link.now_ns(), 0);
  EXPECT_TRUE(std::holds_alternative<Hello>(*link.next_event(20ms)));
  EXPECT_EQ(link.now_ns(), 5'000'000) << "no longer than it takes";
  EXPECT_EQ(link.monotonic_ns(), 5'002'000);
  EXPECT_EQ(link.utc_ns(), 5'001'000);
  EXPECT_TRUE(std::holds_alternative<AgentSilent>(*link.next_event(0ms))) << "at once";
  EXPECT_FALSE(link.next_event(20ms));
  EXPECT_EQ(link.now_ns(), 25'000'000);
  EXPECT_TRUE(std::holds_alternative<AgentGone>(*link.next_event(20ms)));
  EXPECT_FALSE(link.over());
  EXPECT_FALSE(link.next_event(1h));
  EXPECT_EQ(link.now_ns(), 60'000'000);
  EXPECT_TRUE(link.over());
  EXPECT_FALSE(link.next_event(1h));
}

TEST_F(RecordedLinkTest, OrTheMachinesTimesARate) {
  RecordedLink link(file_, 1000);
  std::vector<TimeNs> times_ns;
  while (!link.over()) {
    if (link.next_event(1h)) times_ns.push_back(link.now_ns());
  }
  ASSERT_EQ(times_ns.size(), 3U);
  EXPECT_GE(times_ns[0], 5'000'000);
  EXPECT_GE(times_ns[2], 30'000'000);
  EXPECT_GE(link.now_ns(), 60'000'000);
}

}  // namespace
}  // namespace coslam::recorded_link_test
