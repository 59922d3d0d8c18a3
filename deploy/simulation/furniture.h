// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "deploy/simulation/builder.h"

// Things that fill rooms. Each call is one object with details drawn from the builder's generator. Lengths in metres.
namespace coslam::sim {

void add_bookcase(WorldBuilder& b, const Placement& at, double width_m, double height_m, double depth_m);
void add_table(WorldBuilder& b, const Placement& at, double width_m, double depth_m, double height_m);
void add_sideboard(WorldBuilder& b, const Placement& at, double width_m, double depth_m, double height_m);
void add_chair(WorldBuilder& b, const Placement& at);
void add_sofa(WorldBuilder& b, const Placement& at, double width_m);
void add_carton(WorldBuilder& b, const Placement& at, const Eigen::Vector3d& size_m);
void add_plant(WorldBuilder& b, const Placement& at, double height_m);
void add_monitor(WorldBuilder& b, const Placement& at);
void add_book_stack(WorldBuilder& b, const Placement& at, int books);
void add_vase(WorldBuilder& b, const Placement& at, double radius_m, double height_m);
void add_floor_lamp(WorldBuilder& b, const Placement& at);
// A pillar or beam of one material that stands out of a wall.
void add_block(WorldBuilder& b, const Placement& at, const Eigen::Vector3d& size_m, MaterialKind kind, double tone);

// The front of a wall: a line on the ground with the place of its middle. Along it runs to the right of who faces it.
struct WallFront {
  double x_m = 0, y_m = 0;
  double turn_deg = 0;  // see Placement

  // `out` metres in front of it.
  Placement at(double along_m, double z_m, double out_m = 0) const;
};

// Adds a print on a wall: `at` is the middle of the lower edge, on the wall.
void add_print(WorldBuilder& b, const Placement& at, double width_m, double height_m, MaterialKind kind);
// A tag (material kTag) whose black square has that side, with its margin.
void add_tag(WorldBuilder& b, const Placement& at, double side_m);
// A window with bars, foliage outside, light that comes in.
void add_window(WorldBuilder& b, const Placement& at, double width_m, double height_m, double radiance);
// A board with many notes.
void add_pinboard(WorldBuilder& b, const Placement& at, double width_m, double height_m);
void add_rug(WorldBuilder& b, const Placement& at, double width_m, double depth_m);

// Floor, ceiling and four walls of a room from (x0, y0) to (x1, y1).
struct RoomShell {
  double x0_m = 0, y0_m = 0, x1_m = 0, y1_m = 0, height_m = 3;
  MaterialKind north = MaterialKind::kBrick, east = MaterialKind::kPlaster;
  MaterialKind south = MaterialKind::kPlanks, west = MaterialKind::kPlaster;
  MaterialKind floor = MaterialKind::kPlanks;
};
void add_shell(WorldBuilder& b, const RoomShell& shell);
// Prints, boards, shelves and tables along a wall of a room, from one place to another.
void furnish_wall(WorldBuilder& b, const WallFront& wall, double from_m, double to_m);

}  // namespace coslam::sim
