// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "server/estimator/map_server.h"
#include "tests/support/map_checks.h"
#include "tests/support/sim_run.h"

// Maps of two servers become those of one.
namespace coslam::map_server_merge_test {
namespace {

using test::SimRun;
using test::SimWorld;

Tables tables_of(SimRun& run) {
  Tables tables;
  for (Row& row : run.server().changed_rows()) tables[row.table][row.key] = std::move(row.bytes);
  return tables;
}

MapServer restored(const Tables& tables) {
  MapServer server(RunId(1), {});
  server.restore(tables, 0);
  server.meet_all();
  return server;
}

void map_room(SimRun* run, int from, int cameras) {
  const auto paths = test::paths_side_by_side(from + cameras);
  for (int c = from; c < from + cameras; ++c) run->add_agent(paths[static_cast<std::size_t>(c)]);
  run->step(90);
}

TEST(TakeIn, AMapOfTheSamePlaceBecomesPartOfTheOlderOne) {
  const SimWorld world({});
  SimRun first(world, {}), second(world, {});
  map_room(&first, 0, 2);
  map_room(&second, 1, 2);
  MapServer server = restored(tables_of(first));
  const MapServer other = restored(tables_of(second));
  const MapId known = server.largest_map();
  const std::size_t points = server.map().points().size();
  const MapServer::TakenIn taken = server.take_in(other);
  ASSERT_EQ(taken.joined.size(), 1U);
  EXPECT_EQ(taken.joined.front().remaining, known);
  EXPECT_GE(taken.joined.front().images, 2);
  EXPECT_GE(taken.joined.front().points, 20);
  EXPECT_EQ(server.maps().size(), 1U);
  EXPECT_EQ(server.map().cameras().size(), 4U);
  EXPECT_EQ(server.map().cameras()[2].name, "cam0-2");
  EXPECT_GT(server.map().points().size(), points);
  test::expect_consistent(server.map());
  // The other's cameras are where they were, in the frame of the first.
  const Similarity3 truth_from_map = first.path_error().truth_from_map;
  for (int c = 0; c < 2; ++c) {
    const MapCamera& camera = server.map().cameras()[static_cast<std::size_t>(2 + c)];
    for (const FramePose& f : camera.frames) {
      if (!f.valid()) continue;
      EXPECT_EQ(f.map, known);
      const Rigid3 truth = second.truth(CameraId(static_cast<std::uint16_t>(c)), f.capture_ns - taken.as.later_ns);
      EXPECT_LT((truth_from_map * f.cam_from_world.center() - truth.center()).norm(), 0.05);
    }
  }
  server.finish_whole();
  EXPECT_EQ(server.maps().size(), 1U);
  // What was put together can be saved and loaded, and goes on.
  Tables again;
  for (Row& row : server.changed_rows()) again[row.table][row.key] = std::move(row.bytes);
}

TEST(TakeIn, AnotherPlaceStaysAMapOfItsOwn) {
  const SimWorld here({.seed = 1}), elsewhere({.seed = 2});
  SimRun first(here, {}), second(elsewhere, {});
  map_room(&first, 0, 2);
  map_room(&second, 0, 2);
  MapServer server = restored(tables_of(first));
  const MapServer::TakenIn taken = server.take_in(restored(tables_of(second)));
  EXPECT_TRUE(taken.joined.empty());
  ASSERT_EQ(server.maps().size(), 2U);
  EXPECT_EQ(server.maps()[1].frames.size(), 2U);
  test::expect_consistent(server.map());
}

TEST(TakeIn, ItsTimeComesAfter) {
  const SimWorld world({});
  SimRun run(world, {});
  map_room(&run, 0, 2);
  const Tables tables = tables_of(run);
  MapServer server = restored(tables);
  const TimeNs now_ns = server.map().now_ns();
  const SetId now = server.map().now();
  server.take_in(restored(tables));
  for (std::size_t c = 2; c < 4; ++c) {
    EXPECT_GT(server.map().cameras()[c].frames.front().capture_ns, now_ns);
    EXPECT_GT(server.map().cameras()[c].frames.front().set, now);
  }
}

}  // namespace
}  // namespace coslam::map_server_merge_test
