// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "server/estimator/map_server.h"
#include "tests/support/matchers.h"
#include "tests/support/sim_map.h"
#include "tests/support/sim_run.h"

// Whole simulated runs: what becomes of calibrations that are wrong, and of those that are not.
namespace coslam::map_server_lens_test {
namespace {

using test::PoseNear;
using test::SimRun;
using test::SimWorld;

// Calibrations whose focal length is 5 % too long: ten times what they are worth.
TEST(MapServer, FindsLensesThatAreNotAsCalibrated) {
  const SimWorld world({});
  SimRun run(world, {}, {.noise_px = 0.3, .focal_error = 0.05});
  for (const auto& path : test::paths_side_by_side(3)) run.add_agent(path);
  run.step(180);
  for (const MapCamera& c : run.map().cameras()) {
    EXPECT_NEAR(std::exp(c.lens.log_focal()) * c.model.fx, test::sim_camera().fx, 0.015 * c.model.fx)
        << c.name << ": a calibration that is ten times as wrong as they are still has a say";
    EXPECT_GT(c.lens_sigma[0], 0) << c.name;
    const FramePose& newest = c.frames.back();
    EXPECT_THAT(run.agent(c.id).pose().cam_from_world, PoseNear(newest.cam_from_world, 0.002, 0.005))
        << "the agent goes by the lens that the server found";
  }
  EXPECT_LT(run.path_error().ate, 0.001 * run.path_error().path_m);
  const std::vector<std::string> warnings = run.server().take_warnings();
  EXPECT_EQ(warnings.size(), 3U) << "one for each camera";
  run.server().finish();
  EXPECT_LT(run.path_error().ate, 0.0006 * run.path_error().path_m);
}

TEST(MapServer, LensesThatAreAsCalibratedStay) {
  const SimWorld world({});
  SimRun run(world, {}, {.noise_px = 0.3});
  for (const auto& path : test::paths_side_by_side(3)) run.add_agent(path);
  run.step(120);
  run.server().finish();
  for (const MapCamera& c : run.map().cameras()) EXPECT_TRUE(c.lens.none()) << c.name;
}

}  // namespace
}  // namespace coslam::map_server_lens_test
