// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/status/census.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace coslam::census_test {
namespace {

using std::chrono::milliseconds;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

const RunId kServer(1), kLeft(2), kRight(3);

TEST(Census, RatesLagAndBytes) {
  Census census;
  const Instant start;
  for (std::uint32_t i = 0; i <= 10; ++i) {
    const Instant now = start + i * milliseconds(100);
    census.add(TrackFrame{.agent = "left", .agent_run = kLeft, .frame = FrameId(i)}, 1000, now);
    census.add(TrackFrame{.agent = "left", .agent_run = kLeft, .frame = FrameId(i)}, 0, now);  // again
    MapPatch patch;
    patch.agent = "left";
    patch.agent_run = kLeft;
    patch.after_frame = FrameId(i);
    patch.group = GroupId(2);
    census.add(patch, 200, now + milliseconds(20));
  }
  AgentStatus status{.agent = "left", .agent_run = kLeft, .state = AgentState::kRunning};
  status.pose_state = PoseState::kTracked;
  status.frames = 77;
  status.dropped = 3;
  status.tracks = 123;
  status.frame_ms = 4.5F;
  census.add(status, 0, start);
  EXPECT_THAT(census.text(start + milliseconds(1000)),
              ContainsRegex("left +running +tracked +2 +80 +- +123 +4.5 +10.0 +20.0 +11.0 +2.2\n"));
  AgentImages images{.agent = "left", .agent_run = kLeft};
  images.images[ImageFate::kTracked] = 72;
  images.images[ImageFate::kNotSent] = 8;
  census.add(images, 0, start);
  EXPECT_THAT(census.text(start + milliseconds(1000)),
              ContainsRegex("left +running +tracked +2 +80 +90.0% +123 +4.5 +10.0 +20.0 +11.0 +2.2\n"
                            "  left: of 80 images 8 not sent in time\n"));
  images.complete = true;
  census.add(images, 0, start);
  EXPECT_THAT(census.text(start + milliseconds(1000)), ContainsRegex("left +ended "));
}

TEST(Census, WhoIsMissing) {
  Census census;
  EXPECT_TRUE(census.empty());
  const Instant now;
  census.add(Hello{.agent = "left", .agent_run = kLeft}, 0, now);
  EXPECT_THAT(census.text(now), HasSubstr("no map server\n"));
  EXPECT_THAT(census.text(now), ContainsRegex("left +waiting +none +- "));
  ServerStatus server;
  server.server_run = kServer;
  server.started = true;
  server.agents = {"left", "middle"};
  server.refused = {{kRight, "the name is taken"}};
  census.add(server, 0, now);
  census.add(Hello{.agent = "right", .agent_run = kRight}, 0, now);
  census.set_alive(kLeft, false);
  const std::string text = census.text(now);
  EXPECT_THAT(text, HasSubstr("map server 0000000000000001: running"));
  EXPECT_THAT(text, ContainsRegex("left +silent "));
  EXPECT_THAT(text, ContainsRegex("middle +gone"));
  EXPECT_THAT(text, ContainsRegex("right +refused "));
  EXPECT_THAT(text, HasSubstr("refused: the name is taken\n"));
  census.set_alive(kServer, false);
  EXPECT_THAT(census.text(now), HasSubstr("map server 0000000000000001: silent"));
}

TEST(Census, TheSameForPrograms) {
  Census census;
  const Instant now;
  ServerStatus server;
  server.server_run = kServer;
  server.started = true;
  server.points = 42;
  server.agents = {"left", "middle"};
  server.refused = {{kRight, "the name is taken"}};
  census.add(server, 0, now);
  census.add(Hello{.agent = "left", .agent_run = kLeft}, 1000, now);
  census.add(Hello{.agent = "right", .agent_run = kRight}, 0, now);
  const std::string text = census.json(now + milliseconds(1000));
  EXPECT_EQ(std::ranges::count(text, '\n'), 1);
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["servers"][0]["state"], "running");
  EXPECT_EQ(json["servers"][0]["points"], 42);
  ASSERT_EQ(json["agents"].size(), 3U);
  EXPECT_EQ(json["agents"][0]["name"], "left");
  EXPECT_EQ(json["agents"][0]["state"], "waiting");
  EXPECT_EQ(json["agents"][0]["group"], nullptr);
  EXPECT_EQ(json["agents"][0]["up_kb_s"], 1.0);
  EXPECT_EQ(json["agents"][1]["refused"], "the name is taken");
  EXPECT_EQ(json["agents"][2]["name"], "middle");
  EXPECT_EQ(json["agents"][2]["state"], "gone");
}

TEST(Census, ALineForEachObject) {
  Census census;
  const Instant now;
  MovingState state{.server_run = kServer, .map = MapId(1), .scale_known = true};
  state.objects.push_back({ObjectId(4), {1, 2, 3}, {0.6F, 0.8F, 0}, {0.5F, 1.7F, 0.4F}, 9});
  census.add(state, 0, now);
  EXPECT_THAT(census.text(now), HasSubstr("object 4: 9 points at 1.00 2.00 3.00, 1.00 m/s, 0.50 x 1.70 x 0.40 m\n"));
  state.objects.clear();
  census.add(state, 0, now);
  EXPECT_THAT(census.text(now), ::testing::Not(HasSubstr("object 4")));
}

}  // namespace
}  // namespace coslam::census_test
