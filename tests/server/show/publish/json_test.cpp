// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/json.h"

#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace coslam::json_test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;

PublicState state_of(std::vector<PublicAgent> agents) {
  PublicState state;
  state.t_ns = 2'400'000'000;
  state.main = MapId(1);
  state.run = RunId(7);
  state.agents = std::move(agents);
  return state;
}

PublicAgent agent_named(const std::string& name) {
  PublicAgent agent;
  agent.facts.name = name;
  return agent;
}

json agent_json(const PublicAgent& agent) {
  RosNames names;
  return json::parse(agents_json(state_of({agent}), Rates(), names)).at(0);
}

TEST(StateJson, AStateWithoutAgentsIsWhole) {
  RosNames names;
  const json state = json::parse(state_json(PublicState(), Rates(), names));
  EXPECT_EQ(state["agents"], json::array());
  EXPECT_EQ(state["links"], json::array());
  EXPECT_EQ(state["groups"], json::array());
  EXPECT_EQ(state["run"], "");
}

TEST(StateJson, WhatOnlyARunAtWorkKnowsIsNullInAResult) {
  RosNames names;
  PublicState state = state_of({agent_named("left")});
  state.key_frames = 9;
  state.loop.lost["sets_left_out"] = 4;
  state.loop.memory_mib = 12.34;
  const json live = json::parse(state_json(state, Rates(), names));
  EXPECT_EQ(live["server"]["key_frames"], 9);
  EXPECT_EQ(live["server"]["left_out"], 4);
  EXPECT_EQ(live["server"]["memory_mib"], 12.3);
  EXPECT_EQ(live["agents"][0]["losses"], "");
  EXPECT_EQ(live["agents"][0]["account"]["tracked"], 0);
  state.run = RunId();
  const json told = json::parse(state_json(state, Rates(), names));
  for (const char* key : {"key_frames", "left_out", "memory_mib"}) EXPECT_TRUE(told["server"][key].is_null()) << key;
  for (const char* key : {"kB_up_per_s", "kB_down_per_s", "lag_s", "lost_percent", "account", "losses"}) {
    EXPECT_TRUE(told["agents"][0][key].is_null()) << key;
  }
}

TEST(StateJson, EveryStandingHasItsWord) {
  std::vector<std::string> words;
  for (const auto standing : {PublicStanding::kNone, PublicStanding::kTracking, PublicStanding::kRelative,
                              PublicStanding::kLost, PublicStanding::kUnheard}) {
    PublicAgent agent = agent_named("left");
    agent.standing = standing;
    words.push_back(agent_json(agent)["state"]);
  }
  EXPECT_THAT(words, ElementsAre("none", "tracking", "relative", "lost", "unheard"));
}

TEST(StateJson, AnAgentInNoMapHasNoFrame) {
  PublicAgent agent = agent_named("left");
  EXPECT_EQ(agent_json(agent)["frame"], "");
  EXPECT_EQ(agent_json(agent)["map"], 0);
  agent.map = MapId(3);
  EXPECT_EQ(agent_json(agent)["frame"], "map_3");
  EXPECT_TRUE(agent_json(agent)["path"].is_null());
}

TEST(StateJson, FiguresHaveAsManyDigitsAsTheyAreWorth) {
  PublicAgent agent = agent_named("left");
  agent.rate_hz = 29.96;
  agent.facts.status.frame_ms = 7.049F;
  agent.clock_offset_s = 0.25;
  const json told = agent_json(agent);
  EXPECT_EQ(told["rate_hz"], 30.0);
  EXPECT_EQ(told["frame_ms"], 7.0);
  EXPECT_EQ(told["clock_offset_ms"], 250.0);
}

TEST(StateJson, NumbersThatAreNoneAndTextThatIsNoneLeaveItReadable) {
  PublicAgent agent = agent_named("left");
  agent.why = "lost \xff\xfe at \"1\"\n";
  agent.rate_hz = std::numeric_limits<double>::quiet_NaN();
  agent.clock_offset_s = std::numeric_limits<double>::infinity();
  const json told = agent_json(agent);
  EXPECT_TRUE(told["rate_hz"].is_null());
  EXPECT_TRUE(told["clock_offset_ms"].is_null());
  EXPECT_EQ(told["why"], "lost \xef\xbf\xbd\xef\xbf\xbd at \"1\"\n");
}

TEST(GroupsJson, HasGroupsAndWhatTheyShare) {
  PublicState state = state_of({});
  state.groups = {{"left", "right"}, {"far"}};
  state.links = {{"left", "right", 31}};
  EXPECT_EQ(groups_json(state), R"({"t_s":2.4,"groups":[["left","right"],["far"]],"links":[["left","right",31]]})");
}

TEST(EventJson, KeepsWhateverItsTextIs) {
  const json event = json::parse(event_json({1'500'000'000, "lost", "left \"is\" \\ lost", {"left", "right"}}));
  EXPECT_EQ(event["t_s"], 1.5);
  EXPECT_EQ(event["text"], "left \"is\" \\ lost");
  EXPECT_EQ(event["agents"].size(), 2U);
}

TEST(TracksJson, PixelsAreThoseOfTheImageAsItWasTaken) {
  PublicImage image{.agent = "left", .capture_ns = 100'000'000};
  image.camera = {640, 480, 400, 400, 320, 240, DistortionModel::kRadTan, {-0.2, 0.05, 0, 0}};
  EXPECT_EQ(tracks_json(image), R"({"t_s":0.1,"width":640,"height":480,"tracks":[]})");
  const Eigen::Vector2d raw_px(611.3, 40.7);
  const auto undistorted_px = image.camera.undistorted_from_raw(raw_px);
  ASSERT_TRUE(undistorted_px);
  image.tracks = {{TrackId(4294967295U), undistorted_px->cast<float>(), PublicTrackState::kUncertain}};
  EXPECT_EQ(tracks_json(image), R"({"t_s":0.1,"width":640,"height":480,"tracks":[[4294967295,611.3,40.7,3]]})");
}

TEST(TracksJson, TracksWithoutAPlaceAreLeftOut) {
  PublicImage image{.agent = "left", .capture_ns = 0};
  image.camera = {640, 480, 400, 400, 320, 240, DistortionModel::kNone, {}};
  const float nan = std::numeric_limits<float>::quiet_NaN(), far = std::numeric_limits<float>::infinity();
  image.tracks = {{TrackId(1), {nan, 3}, PublicTrackState::kStatic},
                  {TrackId(2), {5, 6}, PublicTrackState::kStatic},
                  {TrackId(3), {5, -far}, PublicTrackState::kStatic},
                  {TrackId(4), {7, 8}, PublicTrackState::kNone}};
  EXPECT_EQ(json::parse(tracks_json(image))["tracks"], json::parse("[[2,5.0,6.0,1],[4,7.0,8.0,0]]"));
}

TEST(JsonSchemas, AreJsonThatNamesEveryKey) {
  RosNames names;
  PublicImage image;
  const std::pair<std::string_view, std::string> schemas[] = {{kStateSchema, state_json(state_of({}), Rates(), names)},
                                                              {kEventSchema, event_json({})},
                                                              {kTracksSchema, tracks_json(image)}};
  for (const auto& [schema, message] : schemas) {
    const json properties = json::parse(schema)["properties"], told = json::parse(message);
    EXPECT_EQ(properties.size(), told.size());
    for (const auto& [key, value] : told.items()) EXPECT_TRUE(properties.contains(key)) << key;
  }
}

}  // namespace
}  // namespace coslam::json_test
