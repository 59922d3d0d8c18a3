// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/record/recording_link.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>

#include "common/base/error.h"
#include "deploy/coslam/run/inline_link.h"
#include "server/fleet/record/recording.h"
#include "tests/support/temp_folder.h"
#include "tests/support/wire_equal.h"
#include "tests/support/wire_values.h"

namespace coslam::recording_link_test {
namespace {

using namespace std::chrono_literals;
using test::error_of;
using ::testing::HasSubstr;
using ::testing::SizeIs;

const RunId kServer(1), kRun(9);

std::vector<TimedEvent> events_in(const std::filesystem::path& file) {
  Recording recording(file);
  std::vector<TimedEvent> events;
  while (auto event = recording.next()) events.push_back(std::move(*event));
  return events;
}

RecordingHead head() { return {.server_run = kServer, .configuration = nlohmann::ordered_json::object()}; }

class RecordingLinkTest : public ::testing::Test {
 protected:
  test::TempFolder temp_;
  const std::filesystem::path file_ = temp_ / "new folder/a.rec";
  InlineLink link_{kServer};
  test::WireValues values_{1};
};

TEST_F(RecordingLinkTest, WritesWhatIsTakenWithItsTime) {
  TrackFrame frame = values_.frame("cam0", kRun, 0);
  {
    RecordingLink recording(link_.server(), file_, head());
    auto agent = link_.connect(values_.hello("cam0", kRun));
    agent->send(frame, {}, {});
    int taken = 0;
    while (recording.next_event(0ms)) ++taken;
    EXPECT_EQ(taken, 2) << "passed on";
    agent.reset();
    EXPECT_TRUE(recording.next_event(0ms));
    recording.end();
    auto late = link_.connect(values_.hello("cam1", RunId(10)));
    EXPECT_TRUE(recording.next_event(0ms)) << "after the end of the recording";
  }
  const auto events = events_in(file_);
  ASSERT_THAT(events, SizeIs(3));
  EXPECT_EQ(std::get<Hello>(events[0].event).agent, "cam0");
  test::expect_same(std::get<JoinedFrame>(events[1].event).frame, frame);
  EXPECT_EQ(std::get<AgentGone>(events[2].event).agent_run, kRun);
  EXPECT_EQ(events[0].t_ns, events[1].t_ns) << "taken at once";
  EXPECT_GT(events[2].t_ns, events[1].t_ns);
  const RecordingSummary summary = check_recording(file_);
  EXPECT_FALSE(summary.cut_off);
  EXPECT_GE(summary.t_ns, events[2].t_ns);
  EXPECT_EQ(summary.head.server_run, kServer);
  EXPECT_FALSE(summary.head.version.empty());
}

TEST_F(RecordingLinkTest, WithoutAnEndItIsCutOff) {
  {
    Recorder recorder(file_, head());
    recorder.add(values_.hello("cam0", kRun), 5);
  }
  const RecordingSummary summary = check_recording(file_);
  EXPECT_TRUE(summary.cut_off);
  EXPECT_EQ(summary.t_ns, 5);
}

TEST_F(RecordingLinkTest, WithoutAnEventThereIsNoFile) {
  {
    Recorder recorder(file_, head());
    EXPECT_TRUE(std::filesystem::exists(file_));
    EXPECT_THAT(error_of<UserError>([&] { Recorder second(file_, head()); }), HasSubstr("exists already"));
    recorder.end();
  }
  EXPECT_FALSE(std::filesystem::exists(file_));
}

// Files of this process may not grow beyond a size, as on a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t most_bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit full{most_bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &full);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_F(RecordingLinkTest, AFullDiskEndsTheRecordingAlone) {
  {
    const FullDisk disk(20'000);
    Recorder recorder(file_, head());
    recorder.add(values_.hello("cam0", kRun), 0);
    for (std::uint32_t i = 0; i < 100; ++i) recorder.add(JoinedFrame{values_.frame("cam0", kRun, i), {}, {}}, i);
    recorder.end();
  }
  const RecordingSummary summary = check_recording(file_);
  EXPECT_TRUE(summary.cut_off);
  EXPECT_GT(events_in(file_).size(), 5U);
  EXPECT_LT(events_in(file_).size(), 100U);
  EXPECT_LE(std::filesystem::file_size(file_), 20'000U);
}

// Whether the writer falls behind is up to the machine; that nothing waits for it and nothing is torn is not.
TEST_F(RecordingLinkTest, MoreThanTheDiskTakesEndsTheRecordingAlone) {
  const std::uint32_t frames = 4 * Recorder::kQueue;
  {
    const TrackFrame frame = values_.frame("cam0", kRun, 0);
    Recorder recorder(file_, head());
    recorder.add(values_.hello("cam0", kRun), 0);
    for (std::uint32_t i = 0; i < frames; ++i) {
      JoinedFrame joined{frame, {}, {}};
      joined.frame.frame = FrameId(i);
      recorder.add(std::move(joined), i);
    }
    recorder.end();
  }
  const auto events = events_in(file_);
  ASSERT_GE(events.size(), Recorder::kQueue) << "what was taken is written";
  for (std::size_t i = 1; i < events.size(); ++i)
    ASSERT_EQ(std::get<JoinedFrame>(events[i].event).frame.frame.value, i - 1) << "without a gap";
  EXPECT_EQ(check_recording(file_).cut_off, events.size() < frames + 1);
}

TEST_F(RecordingLinkTest, NoRoomAtAllIsSaidAtTheStart) {
  const FullDisk disk(4);
  EXPECT_THAT(error_of<UserError>([&] { Recorder recorder(file_, head()); }), HasSubstr("cannot be written: File too"));
  EXPECT_FALSE(std::filesystem::exists(file_));
}

}  // namespace
}  // namespace coslam::recording_link_test
