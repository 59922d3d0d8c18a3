// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/live_api.h"

#include <gmock/gmock.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "common/dataset/event_file.h"
#include "tests/support/eventually.h"
#include "tests/support/temp_folder.h"

namespace coslam::live_api_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class LiveApiTest : public ::testing::Test {
 protected:
  // Empty: not answered yet.
  std::optional<WebAnswer> ask(const std::string& target) {
    const auto request = parse_target(target);
    const std::size_t before = answers_.values().size();
    api_.answer(*request, [this](const WebAnswer& answer) { answers_.add(answer); });
    const auto all = answers_.values();
    return all.size() > before ? std::optional(all.back()) : std::nullopt;
  }
  WebAnswer wait() {
    EXPECT_TRUE(answers_.wait_count(1));
    return answers_.values().back();
  }
  void tell(bool placed, const std::string& result = "") {
    PublicState state;
    state.t_ns = 1'000'000'000;
    PublicAgent agent;
    agent.facts.name = "cam0";
    agent.alive = true;
    if (placed) agent.cam_from_map = Rigid3();
    state.agents.push_back(agent);
    state.groups = {{"cam0"}};
    state.loop.at_work = true;
    state.loop.result = result;
    Snapshot s;
    s.state = std::make_shared<const PublicState>(state);
    api_.see(s);
  }
  void tell_cloud() {
    PublicCloud cloud{{0, MapId(1)}, {}};
    cloud.points = {{{1, 2, 3}, 0.5F, PointId(7), MapId(1), false, 3},
                    {{4, 5, 6}, 0.5F, PointId(8), MapId(1), true, 3},
                    {{7, 8, 9}, 0.5F, PointId(9), MapId(2), false, 3}};
    Snapshot s;
    s.cloud = std::make_shared<const PublicCloud>(cloud);
    api_.see(s);
  }

  test::Collector<WebAnswer> answers_;
  LiveApi api_;
};

TEST_F(LiveApiTest, HealthAndReadiness) {
  EXPECT_EQ(ask("/healthz")->status, 200) << "it has only just begun";
  EXPECT_EQ(ask("/readyz")->status, 503);
  tell(false);
  EXPECT_THAT(ask("/readyz")->body, HasSubstr("no agent has a place"));
  tell(true);
  EXPECT_EQ(ask("/readyz")->status, 200);
}

TEST_F(LiveApiTest, AgentsGroupsAndMetrics) {
  EXPECT_EQ(ask("/api/v1/agents")->status, 503);
  tell(true);
  const auto agents = nlohmann::json::parse(ask("/api/v1/agents")->body);
  EXPECT_EQ(agents[0]["name"], "cam0");
  EXPECT_EQ(nlohmann::json::parse(ask("/api/v1/groups")->body)["groups"][0][0], "cam0");
  api_.count([] {
    WebCounts c;
    c.dropped = 3;
    return c;
  });
  const WebAnswer metrics = *ask("/metrics");
  EXPECT_THAT(metrics.type, HasSubstr("version=0.0.4"));
  EXPECT_THAT(std::string(metrics.body), HasSubstr("coslam_up 1\n"));
  EXPECT_THAT(std::string(metrics.body), HasSubstr("coslam_agent_has_pose{agent=\"cam0\"} 1\n"));
  EXPECT_THAT(std::string(metrics.body), HasSubstr("coslam_view_dropped_total 3\n"));
  EXPECT_EQ(ask("/api/v1/nothing")->status, 404);
}

TEST_F(LiveApiTest, AnImageOfACameraComesWhenItWasAskedFor) {
  tell(true);
  EXPECT_EQ(ask("/api/v1/thumbnail")->status, 400);
  EXPECT_EQ(ask("/api/v1/thumbnail?agent=cam7")->status, 404);
  EXPECT_THAT(ask("/api/v1/thumbnail?agent=cam0")->body, HasSubstr("of this run give no images"));
  std::vector<std::string> looked;
  std::optional<Thumbnail> newest;
  api_.look_by([&](const std::string& agent) {
    looked.push_back(agent);
    return newest;
  });
  EXPECT_EQ(ask("/api/v1/thumbnail?agent=cam7")->status, 404);
  EXPECT_EQ(ask("/api/v1/thumbnail?agent=cam0")->status, 202);
  EXPECT_THAT(looked, testing::ElementsAre("cam0"));
  newest = Thumbnail{"cam0", RunId(1), 0, {'j', 'p', 'g'}};
  const WebAnswer image = *ask("/api/v1/thumbnail?agent=cam0");
  EXPECT_EQ(image.status, 200);
  EXPECT_EQ(image.type, "image/jpeg");
  EXPECT_EQ(image.body, "jpg");
  newest->jpeg.clear();
  EXPECT_EQ(ask("/api/v1/thumbnail?agent=cam0")->status, 403);
}

TEST_F(LiveApiTest, TheMapIsCopiedWhenSomebodyAsksForIt) {
  EXPECT_FALSE(api_.parts().has(Part::kCloud));
  EXPECT_FALSE(ask("/api/v1/map.ply"));
  EXPECT_TRUE(api_.parts().has(Part::kCloud));
  tell_cloud();
  EXPECT_FALSE(api_.parts().has(Part::kCloud));
  const WebAnswer answer = wait();
  EXPECT_EQ(answer.status, 200);
  const std::string ply(answer.body);
  EXPECT_THAT(ply, StartsWith("ply\nformat binary_little_endian 1.0\nelement vertex 1\n"));
  const std::size_t data = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size() - data, 20U) << "what is proven of the main map";
  float z = 0;
  std::memcpy(&z, &ply[data + 8], sizeof z);
  EXPECT_EQ(z, 3);
  EXPECT_TRUE(ask("/api/v1/map.ply")) << "and is fresh for a while";
}

TEST_F(LiveApiTest, ExplainsFromTheResult) {
  const auto early = ask("/api/v1/explain?kind=point&id=1");
  EXPECT_EQ(early->status, 404);
  EXPECT_THAT(early->body, HasSubstr("nothing yet"));
  EXPECT_EQ(ask("/api/v1/explain?kind=door&id=1")->status, 400);
  EXPECT_EQ(ask("/api/v1/explain?kind=point&id=1&at=x")->status, 400);
  const test::TempFolder folder;
  tell(true, folder.path().string());
  answers_.wait_count(3);
  ask("/api/v1/explain?kind=camera&id=cam0");
  EXPECT_TRUE(answers_.wait_count(4));
  EXPECT_THAT(answers_.values().back().body, HasSubstr("events.csv"));
  {
    EventWriter events(folder / "events.csv");
    events.write({.t_ns = 0, .kind = "camera_joined", .why = "hello", .camera = "cam0"});
    events.close();
  }
  ask("/api/v1/explain?kind=camera&id=cam0");
  EXPECT_TRUE(answers_.wait_count(5));
  EXPECT_EQ(answers_.values().back().status, 200);
  EXPECT_THAT(answers_.values().back().body, HasSubstr("said hello"));
  ask("/api/v1/explain?kind=camera&id=nobody");
  EXPECT_TRUE(answers_.wait_count(6));
  EXPECT_EQ(answers_.values().back().status, 404);
}

}  // namespace
}  // namespace coslam::live_api_test
