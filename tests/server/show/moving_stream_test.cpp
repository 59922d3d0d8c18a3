// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A planner beside agents and a map server, over the real middleware.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <thread>

#include "agent/link/dds_agent_link.h"
#include "server/app/server_loop.h"
#include "server/fleet/link/dds_server_link.h"
#include "tests/support/eventually.h"
#include "tests/support/planner.h"
#include "tests/support/sim_map.h"
#include "tests/support/sim_run.h"
#include "tests/support/test_domain.h"

namespace coslam::moving_stream_test {
namespace {

using namespace std::chrono_literals;

struct Camera {
  test::SimAgent agent;
  std::unique_ptr<AgentLink> link;
};

// One frame of every camera, and the server's answers.
bool step(std::vector<Camera>& cameras, std::uint32_t frame) {
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const CameraFrame f = cameras[c].agent.step(CameraId(static_cast<std::uint16_t>(c)), test::kPeriodNs * frame);
    cameras[c].link->send(f.frame, f.patches, f.descriptors);
  }
  // In turns: a frame that was lost is sent again only while its answer is waited for.
  std::vector<bool> answered(cameras.size());
  const auto end = std::chrono::steady_clock::now() + test::kDeadline;
  while (!std::ranges::all_of(answered, std::identity()) && std::chrono::steady_clock::now() < end) {
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      if (answered[c]) continue;
      const auto patch = cameras[c].link->wait_patch(FrameId(frame), 20ms);
      if (!patch) continue;
      cameras[c].agent.give(*patch);
      answered[c] = patch->after_frame >= FrameId(frame);
    }
  }
  return std::ranges::all_of(answered, std::identity());
}

TEST(MovingStream, APlannerHearsOfTheObjects) {
  const test::TestDomain domain;
  const WireConfig wire = loopback_config(domain.number());
  const test::SimWorld world({.points = 300, .moving_points = 50});
  const auto paths = test::paths_side_by_side(3);
  std::vector<Camera> cameras;
  ServerLoopConfig config;
  config.server.map.of<ScaleConfig>().baseline_m = (paths[0](0).center() - paths[1](0).center()).norm();
  for (std::size_t c = 0; c < paths.size(); ++c) {
    const std::string name = "cam" + std::to_string(c);
    test::SimAgent agent(world, paths[c], {}, name, RunId(100 + c));
    auto link = open_agent_link(wire, agent.tracker().hello());
    cameras.push_back({std::move(agent), std::move(link)});
    config.expected_agents.push_back(name);
  }
  const auto link = open_server_link(wire, RunId(7));
  ServerLoop loop(*link, RunId(7), config);
  test::Planner planner(wire);
  const std::jthread server([&](const std::stop_token& stop) {
    while (!stop.stop_requested() && loop.poll(10ms)) {
    }
  });
  std::optional<MovingState> heard;
  for (std::uint32_t frame = 0; frame < 200; ++frame) {
    ASSERT_TRUE(step(cameras, frame)) << frame;
    auto newest = planner.newest();
    if (newest && newest->objects.size() == 2) heard = std::move(newest);
    if (heard && frame > 60) break;
  }
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->server_run, RunId(7));
  EXPECT_TRUE(heard->scale_known);
  EXPECT_EQ(heard->t_ns % test::kPeriodNs, 0) << "a capture time";
  for (const MovingObjectState& o : heard->objects) {
    EXPECT_GT(o.velocity_per_s.norm(), 0.2);
    EXPECT_LT(o.velocity_per_s.norm(), 1.5);
    EXPECT_LT(o.extent.maxCoeff(), 2.0);
    EXPECT_GE(o.points, 2);
  }
  EXPECT_GT(std::ranges::count_if(heard->points, [](const MovingPointState& p) { return p.object != ObjectId(); }), 3);
}

}  // namespace
}  // namespace coslam::moving_stream_test
