// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/main_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/sim_run.h"

namespace coslam::main_map_test {
namespace {

// Looks to its side, at nothing that a camera on the other side sees.
test::CameraPath aside(double side) {
  return [=](double t_s) {
    const Eigen::Vector3d center_m(side * 0.9 + 0.6 * std::sin(1.3 * t_s + side), 0.15 * std::sin(2 * t_s),
                                   0.2 * std::sin(t_s));
    return test::looking(center_m, side * 0.9);
  };
}

TEST(MainMap, IsTheOneWithTheMostFrames) {
  const test::SimWorld world({.points = 900});
  test::SimRun run(world, {});
  for (const double side : {-1.0, 1.0, -1.1}) run.add_agent(aside(side));
  MainMap main;
  EXPECT_EQ(main.id(), MapId());
  for (int i = 0; i < 60; ++i) {
    run.step();
    main.after_set(run.map(), run.last_set(), run.server().journal());
  }
  ASSERT_EQ(run.server().maps().size(), 2U);
  EXPECT_EQ(main.maps(), 2U);
  EXPECT_EQ(main.id(), run.server().largest_map());
}

TEST(MainMap, ChangesOnlyForOneThatIsClearlyLarger) {
  Map map{MapConfig{}};
  MainMap main;
  main.begin_with(MapId(1), 100);
  main.after_set(map, {}, {});
  main.begin_with(MapId(2), 120);
  main.after_set(map, {}, {});
  EXPECT_EQ(main.id(), MapId(1));
  main.begin_with(MapId(2), 10);
  main.after_set(map, {}, {});
  EXPECT_EQ(main.id(), MapId(2));
}

TEST(MainMap, GoesWithTheMapThatItBecamePartOf) {
  Map map{MapConfig{}};
  MainMap main;
  main.begin_with(MapId(1), 100);
  main.begin_with(MapId(2), 90);
  main.after_set(map, {}, {});
  Journal journal;
  journal.note({.kind = EventKind::kMapMerged, .why = Why::kMapsMet, .map = MapId(2), .from = MapId(1)});
  main.after_set(map, {}, journal);
  EXPECT_EQ(main.id(), MapId(2));
  EXPECT_EQ(main.maps(), 1U);
}

}  // namespace
}  // namespace coslam::main_map_test
