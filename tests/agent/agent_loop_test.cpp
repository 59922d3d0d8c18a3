// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/agent_loop.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "common/base/error.h"
#include "tests/support/sim_tracker.h"
#include "tests/support/temp_folder.h"

namespace coslam::agent_loop_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr RunId kRun(5), kServer(9);
constexpr TimeNs kPeriodNs = 33'333'333;

// Time that passes only where something waits.
struct Time {
  std::chrono::steady_clock::time_point now{std::chrono::hours(1)};
};

// An agent's end of a link that goes nowhere.
class FakeLink final : public AgentLink {
 public:
  explicit FakeLink(Time& time) : time_(time) {}

  void send(TrackFrame frame, const std::optional<PatchReply>&,
            const std::optional<DescriptorReply>& descriptors) override {
    sent.push_back(std::move(frame));
    if (descriptors) described.push_back(*descriptors);
  }
  bool take_thumbnail_request() override { return std::exchange(looked_at, false); }
  void send(const AgentMessage& message) override {
    message.visit([this](const auto& value) { note(value); });
  }
  void note(const AgentStatus& status) { statuses.push_back(status); }
  void note(const Thumbnail& thumbnail) { thumbnails.push_back(thumbnail); }
  void limit_replies(const ReplyLimits& limits) override { found_narrow = limits.narrow_link; }
  std::optional<MapPatch> wait_patch(FrameId after_frame, std::chrono::milliseconds timeout) override {
    waited_for.push_back(after_frame);
    if (const auto patch = pop()) return patch;
    time_.now += timeout;
    if (on_timeout) on_timeout();
    return std::nullopt;
  }
  std::vector<MapPatch> take_patches() override {
    std::vector<MapPatch> all;
    while (auto patch = pop()) all.push_back(std::move(*patch));
    return all;
  }
  std::optional<ServerStatus> server_status() const override { return server; }
  std::optional<ServerStatus> wait_server_status(std::chrono::milliseconds) override { return server; }
  bool server_alive() const override { return alive; }
  LinkBytes bytes() const override { return {}; }
  const RejectionCounts& rejections() const override { return rejections_; }

  // The server's answer to a frame; how long the frame and the answer took, beyond the least for the frame.
  void answer(FrameId frame, float uplink_wait_s = 0, double downlink_s = 0) {
    MapPatch& p = arrived.emplace_back();
    p.server_run = kServer;
    p.agent_run = kRun;
    p.sequence = ++sequence_;
    p.snapshot = sequence_ == 1;
    p.after_frame = frame;
    p.uplink_wait_s = uplink_wait_s;
    p.sent_ns = 1;
    p.received_ns = 1 + to_ns(downlink_s);
  }

  bool found_narrow = false, looked_at = false;
  std::vector<Thumbnail> thumbnails;
  std::vector<TrackFrame> sent;
  std::vector<DescriptorReply> described;
  std::vector<AgentStatus> statuses;
  std::vector<FrameId> waited_for;
  std::deque<MapPatch> arrived;
  std::function<void()> on_timeout;
  std::optional<ServerStatus> server;
  bool alive = true;

 private:
  std::optional<MapPatch> pop() {
    if (arrived.empty()) return std::nullopt;
    MapPatch patch = std::move(arrived.front());
    arrived.pop_front();
    return patch;
  }
  Time& time_;
  std::uint32_t sequence_ = 0;
  RejectionCounts rejections_;
};

class FakeFeed final : public Feed {
 public:
  // prepare: what it is to do with the next image.
  FakeFeed(std::uint32_t images, std::function<void(Image&)> prepare) : images_(images), prepare_(std::move(prepare)) {}
  std::optional<Image> next(const std::atomic<bool>& stop) override {
    if (stop || next_ == images_) return std::nullopt;
    const std::uint32_t i = next_++;
    Image image{FrameId(i), kPeriodNs * i, {}};
    prepare_(image);
    return image;
  }
  std::uint32_t dropped() const override { return 7; }

 private:
  std::uint32_t images_, next_ = 0;
  std::function<void(Image&)> prepare_;
};

class AgentLoopTest : public testing::Test {
 protected:
  explicit AgentLoopTest(Pacing pacing = Pacing::kLockstep, std::uint32_t images = 1000) {
    auto tracker =
        std::make_unique<test::SimTracker>(world_, test::wave_path({}), test::TrackingConfig{}, "cam0", kRun);
    tracker_ = tracker.get();
    Hello hello = tracker->hello();
    hello.pacing = pacing;
    loop_ = std::make_unique<AgentLoop>(link_, std::make_unique<FakeFeed>(images, [this](Image& i) { prepare(i); }),
                                        hello, AgentConfig{}, std::move(tracker), [this] { return time_.now; });
  }
  void prepare(Image& image) const {
    image.available_since = since_;
    image.fault = fault_;
    image.grey = grey_;
  }
  bool step() { return loop_->step(stop_); }
  // Steps, each with the answer to the frame before.
  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      if (!link_.sent.empty()) link_.answer(link_.sent.back().frame);
      ASSERT_TRUE(step());
    }
  }
  ServerStatus refusing() const {
    ServerStatus s;
    s.server_run = kServer;
    s.refused = {{kRun, "the name is taken"}};
    return s;
  }

  const test::SimWorld world_{{.points = 100}};
  Time time_;
  std::optional<Instant> since_;          // when the next image was there
  ImageFault fault_ = ImageFault::kNone;  // of the next image
  cv::Mat grey_;
  FakeLink link_{time_};
  std::atomic<bool> stop_{false};
  test::SimTracker* tracker_ = nullptr;
  std::unique_ptr<AgentLoop> loop_;
};

TEST_F(AgentLoopTest, LockstepFinishesAFrameWhenTheOneBeforeIsAnswered) {
  ASSERT_TRUE(step());
  EXPECT_THAT(link_.waited_for, IsEmpty()) << "nothing is owed before the first frame";
  link_.answer(FrameId(0));
  ASSERT_TRUE(step());
  EXPECT_THAT(link_.waited_for, ElementsAre(FrameId(0)));
  // Late patches come first; the frame waits for the one that has seen the frame before.
  link_.answer(FrameId(0));
  link_.on_timeout = [&] {
    EXPECT_THAT(link_.sent, SizeIs(2));
    link_.answer(FrameId(1));
  };
  ASSERT_TRUE(step());
  EXPECT_THAT(link_.waited_for, ElementsAre(FrameId(0), FrameId(1), FrameId(1), FrameId(1)));
  ASSERT_THAT(link_.sent, SizeIs(3));
  EXPECT_EQ(link_.sent[1].applied_patch, 1U);
  EXPECT_EQ(link_.sent[2].applied_patch, 3U);
}

TEST_F(AgentLoopTest, LockstepWaitsForAServerThatIsSlow) {
  ASSERT_TRUE(step());
  const auto asked = time_.now;
  link_.on_timeout = [&] {
    if (time_.now - asked > 1min) link_.answer(FrameId(0));
  };
  EXPECT_TRUE(step());
  EXPECT_THAT(link_.sent, SizeIs(2));
}

TEST_F(AgentLoopTest, LockstepGivesUpAServerThatIsGone) {
  ASSERT_TRUE(step());
  link_.alive = false;
  const auto asked = time_.now;
  EXPECT_THAT(test::error_of<UserError>([&] { step(); }), HasSubstr("no longer answers"));
  EXPECT_GT(time_.now - asked, 5s) << "a pause is no end";
  EXPECT_LT(time_.now - asked, 6s);
  EXPECT_THAT(link_.sent, SizeIs(1));
}

TEST_F(AgentLoopTest, AThumbnailGoesWhenSomebodyLooksOnceASecondAtMost) {
  grey_ = cv::Mat(48, 64, CV_8UC1, cv::Scalar(90));
  run(2);
  EXPECT_THAT(link_.thumbnails, IsEmpty()) << "nobody looks";
  for (int i = 0; i < 40; ++i, time_.now += 100ms) {
    link_.looked_at = true;
    run(1);
  }
  EXPECT_THAT(link_.thumbnails, SizeIs(5)) << "in 4 s, where some requests come early";
  EXPECT_EQ(link_.thumbnails[0].capture_ns, 2 * kPeriodNs);
  EXPECT_EQ(link_.thumbnails[0].jpeg[0], 0xFF);
  fault_ = ImageFault::kFeatureless;
  time_.now += 1s;
  link_.looked_at = true;
  ASSERT_TRUE(step());
  EXPECT_THAT(link_.thumbnails, SizeIs(6)) << "an image that is not believed is what people want to see";
}

TEST_F(AgentLoopTest, LockstepEndsWithTheServer) {
  run(3);
  link_.server.emplace().stopping = true;
  EXPECT_FALSE(step());
  EXPECT_THAT(link_.sent, SizeIs(3));
}

TEST_F(AgentLoopTest, StopsWaitingWhenToldTo) {
  run(2);
  link_.on_timeout = [this] { stop_ = true; };
  EXPECT_FALSE(step());
  EXPECT_THAT(link_.sent, SizeIs(2));
}

TEST_F(AgentLoopTest, SaysWhyItWasTurnedAway) {
  ASSERT_TRUE(step());
  link_.server = refusing();
  EXPECT_EQ(test::error_of<UserError>([&] { step(); }), "the name is taken");
}

TEST_F(AgentLoopTest, StatusOnceASecondAndWhenThePoseStateChanges) {
  run(3);
  ASSERT_THAT(link_.statuses, SizeIs(1)) << "at once, then no more for a second";
  EXPECT_EQ(link_.statuses[0].state, AgentState::kRunning);
  EXPECT_EQ(link_.statuses[0].frames, 1U);
  EXPECT_EQ(link_.statuses[0].dropped, 7U);
  EXPECT_EQ(link_.statuses[0].tracks, link_.sent[0].tracks.size());
  time_.now += 1001ms;
  run(2);
  ASSERT_THAT(link_.statuses, SizeIs(2));
  EXPECT_EQ(link_.statuses[1].frames, 4U);
  link_.answer(link_.sent.back().frame);
  link_.arrived.back().placed = PlacedPose{link_.sent.back().frame, tracker_->truth(0)};
  ASSERT_TRUE(step());
  ASSERT_THAT(link_.statuses, SizeIs(3));
  EXPECT_EQ(link_.statuses[2].pose_state, PoseState::kLost) << "placed, but with no point to go by";
}

TEST_F(AgentLoopTest, AnImageThatIsNotToBeBelievedBecomesNoFrame) {
  run(3);
  fault_ = ImageFault::kConcealed;
  ASSERT_TRUE(step());
  fault_ = ImageFault::kNone;
  run(2);
  EXPECT_THAT(link_.sent, SizeIs(5));
  EXPECT_EQ(link_.sent[2].frame, FrameId(2));
  EXPECT_EQ(link_.sent[3].frame, FrameId(4));
  EXPECT_FALSE(link_.sent[3].images_doubted) << "one alone says little";
  EXPECT_THAT(link_.statuses, SizeIs(1));
  link_.answer(FrameId(5));
  loop_->finish(stop_);
  const auto report = nlohmann::json::parse(link_.statuses.back().report_json);
  EXPECT_EQ(report["left_out"], nlohmann::json({{"concealed", 1}}));
  EXPECT_EQ(report["frames"], 13) << "what was left out and dropped included";
}

TEST_F(AgentLoopTest, ThatImagesAreNotToBeBelievedIsToldAtOnceAndThatTheyAreAgain) {
  run(3);
  fault_ = ImageFault::kRepeated;
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(step());
  EXPECT_THAT(link_.sent, SizeIs(3));
  ASSERT_THAT(link_.statuses, SizeIs(2)) << "within the second of the first";
  EXPECT_EQ(link_.statuses[1].image_fault, ImageFault::kRepeated);
  fault_ = ImageFault::kMissing;
  ASSERT_TRUE(step());
  ASSERT_THAT(link_.statuses, SizeIs(2)) << "the first reason stays";
  time_.now += 1001ms;
  ASSERT_TRUE(step());
  EXPECT_THAT(link_.statuses, SizeIs(3)) << "its heart beats on";
  fault_ = ImageFault::kNone;
  run(1);
  ASSERT_THAT(link_.statuses, SizeIs(4));
  EXPECT_EQ(link_.statuses[3].image_fault, ImageFault::kNone);
  EXPECT_EQ(link_.statuses[3].left_out, 10U);
  EXPECT_FALSE(link_.sent.back().images_doubted);
}

TEST_F(AgentLoopTest, SoundImagesBetweenManyDamagedOnesAreDoubted) {
  run(3);
  for (int i = 0; i < 6; ++i) {
    fault_ = i % 2 == 0 ? ImageFault::kOutOfOrder : ImageFault::kNone;
    if (i % 2 == 0) {
      ASSERT_TRUE(step());
    } else {
      run(1);
    }
  }
  EXPECT_THAT(link_.sent, SizeIs(6));
  EXPECT_TRUE(link_.sent.back().images_doubted);
}

class AgentLoopOfFiveImages : public AgentLoopTest {
 protected:
  AgentLoopOfFiveImages() : AgentLoopTest(Pacing::kLockstep, 5) {}
};

TEST_F(AgentLoopOfFiveImages, EndsAndReports) {
  run(5);
  EXPECT_FALSE(step());
  EXPECT_THAT(link_.sent, SizeIs(5));
  link_.answer(FrameId(4));
  loop_->finish(stop_);
  EXPECT_EQ(link_.waited_for.back(), FrameId(4)) << "the server may not have used the last frame yet";
  EXPECT_THAT(link_.arrived, IsEmpty());
  const AgentStatus& last = link_.statuses.back();
  EXPECT_EQ(last.state, AgentState::kFinished);
  EXPECT_EQ(last.frames, 5U);
  const auto report = nlohmann::json::parse(last.report_json);
  EXPECT_EQ(report["frames"], 12) << "those dropped included";
  EXPECT_EQ(report["left_out"], nlohmann::json::object());
  EXPECT_EQ(report["live_tracked_percent"], 0);
  EXPECT_TRUE(report["ms"].contains("track"));
  ASSERT_TRUE(last.last_image) << "nobody can ask for it any more";
  EXPECT_EQ(last.last_image->frame, FrameId(4));
  EXPECT_THAT(last.last_image->tracks, Not(IsEmpty()));
  for (const TrackId id : last.last_image->tracks) {
    EXPECT_TRUE(std::ranges::any_of(link_.sent.back().tracks, [&](const auto& t) { return t.track == id; }))
        << id.value;
  }
}

class AgentLoopOfOneImage : public AgentLoopTest {
 protected:
  AgentLoopOfOneImage() : AgentLoopTest(Pacing::kLockstep, 1) {}
};

TEST_F(AgentLoopOfOneImage, WhatWentWithItsFrameIsNotToldAgain) {
  run(1);
  link_.answer(FrameId(0));
  loop_->finish(stop_);
  EXPECT_FALSE(link_.statuses.back().last_image) << "the first image is described";
}

TEST_F(AgentLoopOfFiveImages, ReportsToNobodyWithoutFailing) {
  run(5);
  link_.on_timeout = [this] { link_.alive = false; };
  loop_->finish(stop_);
  EXPECT_EQ(link_.statuses.back().state, AgentState::kFinished);
}

class LiveAgentLoop : public AgentLoopTest {
 protected:
  LiveAgentLoop() : AgentLoopTest(Pacing::kLive, 100'000) {}
  // How many of the images of the third second are sent; the first ones go slowly.
  template <class Answer>
  std::size_t sent_of_thirty(const Answer& answer) {
    loop_->adapt_to_link();
    std::size_t at_first = 0;
    for (int i = 0; i < 90; ++i, time_.now += std::chrono::nanoseconds(kPeriodNs)) {
      if (i == 60) at_first = link_.sent.size();
      answer(i);
      EXPECT_TRUE(step());
    }
    return link_.sent.size() - at_first;
  }
};

TEST_F(LiveAgentLoop, SendsFewOverALinkThatIsLate) {
  EXPECT_LE(sent_of_thirty([&](int i) { link_.answer(FrameId(static_cast<std::uint32_t>(i)), 0.9F); }), 11U);
}

TEST_F(LiveAgentLoop, ItsOwnDelayIsNoFaultOfTheLink) {
  EXPECT_EQ(sent_of_thirty([&](int) {
              since_ = time_.now - 900ms;
              if (!link_.sent.empty()) link_.answer(link_.sent.back().frame, 0.9F);
            }),
            30U);
}

// Whether lost replies are repeated soon.
TEST_F(LiveAgentLoop, ALinkIsWideAgainTwentySecondsAfterItWasLate) {
  loop_->adapt_to_link();
  std::map<int, bool> narrow;  // of the image
  for (int i = 0; i < 900; ++i, time_.now += std::chrono::nanoseconds(kPeriodNs)) {
    const bool late = i >= 90 && i < 120;
    if (!link_.sent.empty()) link_.answer(link_.sent.back().frame, late ? 0.9F : 0.0F);
    ASSERT_TRUE(step());
    narrow[i] = link_.found_narrow;
  }
  EXPECT_TRUE(narrow[10]) << "not known yet";
  EXPECT_FALSE(narrow[85]);
  EXPECT_TRUE(narrow[130]);
  EXPECT_TRUE(narrow[600]);
  EXPECT_FALSE(narrow[890]);
}

// Where one was lost, those after it wait for it and come together.
TEST_F(LiveAgentLoop, ALostPatchIsNoLateLink) {
  EXPECT_EQ(sent_of_thirty([&](int i) {
              if (link_.sent.empty() || i % 10 != 0) return;
              for (const double waited_s : {0.5, 0.4, 0.3, 0.0}) link_.answer(link_.sent.back().frame, 0, waited_s);
            }),
            30U);
}

TEST_F(LiveAgentLoop, NeverWaitsForTheServer) {
  link_.alive = false;
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(step());
  link_.server.emplace().stopping = true;
  ASSERT_TRUE(step());
  EXPECT_THAT(link_.sent, SizeIs(11));
  EXPECT_THAT(link_.waited_for, IsEmpty());
  link_.answer(FrameId(3));
  link_.answer(FrameId(5));
  ASSERT_TRUE(step());
  EXPECT_EQ(link_.sent.back().applied_patch, 2U) << "what came meanwhile";
  loop_->finish(stop_);
  EXPECT_THAT(link_.waited_for, IsEmpty());
  EXPECT_EQ(link_.statuses.back().state, AgentState::kFinished);
}

TEST_F(LiveAgentLoop, DescribesBesideItsFrames) {
  const auto ask = [&] {
    link_.answer(link_.sent.back().frame);
    link_.arrived.back().descriptor_request = DescriptorRequest::kAtTracks;
  };
  const auto step_until_described = [&](std::size_t times) {
    while (link_.described.size() < times && step()) std::this_thread::yield();
  };
  ASSERT_TRUE(step());
  EXPECT_THAT(link_.described, IsEmpty()) << "the first image, which is described wherever it may be";
  step_until_described(1);
  EXPECT_EQ(link_.described.back().frame, link_.sent.back().frame) << "its features start tracks in a later one";
  link_.answer(link_.sent.back().frame);
  ASSERT_TRUE(step());
  step_until_described(2);  // for the server, which is new
  ask();
  ASSERT_TRUE(step());
  const TrackFrame asked = link_.sent.back();
  EXPECT_EQ(asked.descriptors_sent, DescriptorsSent::kLater);
  ASSERT_THAT(link_.described, SizeIs(2));
  ask();  // again, which waits
  step_until_described(3);
  EXPECT_EQ(link_.described.back().frame, asked.frame);
  EXPECT_LT(link_.described.back().frame, link_.sent.back().frame);
  step_until_described(4);
  ASSERT_THAT(link_.described, SizeIs(4));
  EXPECT_GT(link_.described.back().frame, asked.frame);
}

TEST_F(LiveAgentLoop, SendsTheImageThatItDescribesAtTheEnd) {
  sent_of_thirty([&](int i) { link_.answer(FrameId(static_cast<std::uint32_t>(i)), 0.9F); });
  while (link_.sent.back().frame.value % 30 != 0) ASSERT_TRUE(step());
  ASSERT_TRUE(step());
  const FrameId last(link_.sent.back().frame.value + 1);
  loop_->finish(stop_);
  EXPECT_EQ(link_.sent.back().frame, last);
  ASSERT_TRUE(link_.statuses.back().last_image);
  EXPECT_EQ(link_.statuses.back().last_image->frame, last);
}

TEST_F(LiveAgentLoop, SaysWhyItWasTurnedAway) {
  ASSERT_TRUE(step());
  link_.server = refusing();
  time_.now += 2s;
  EXPECT_EQ(test::error_of<UserError>([&] { step(); }), "the name is taken");
}

}  // namespace
}  // namespace coslam::agent_loop_test
