// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/geometry/rigid3.h"

namespace coslam {

// Pose graph: poses of several cameras over time that drifted, and constraints from a recognised place (paper 6.2, step
// 2). Ties are the hard constraints (11), (12), links the soft ones (14).
struct PoseGraph {
  struct Node {
    Rigid3 cam_from_world;
    bool fixed = false;
  };
  // Soft constraint: the relative pose of two nodes stays as it was, with `weight` of its squared residual.
  struct Link {
    int first = 0, second = 0;
    double weight = 1;
  };
  // Hard constraint: the pose of `node` follows exactly from that of `to`. The translation is in the unit of length
  // around `to`.
  struct Tie {
    int node = 0, to = 0;
    Rigid3 node_from_to;
    double scale = 1;  // unit of length around `to` for one around `node`, before the correction
  };
  std::vector<Node> nodes;
  std::vector<Link> links;
  std::vector<Tie> ties;  // at most one per node, without cycles; not of a fixed node
};

struct PoseGraphSolution {
  bool ok = false;
  // Corrected node: the new world around it is the old one, scaled by `scale` and seen from the new pose.
  struct Corrected {
    Rigid3 cam_from_world;
    double scale = 1;
    // Transform of map points and poses near the node.
    Similarity3 new_from_old;
  };
  std::vector<Corrected> nodes;
};

// Solves a pose graph. Linear and sparse: rotations first (16), each then brought to SO(3); then translations (17). A
// tie's node is replaced by its definition, which is the exact solution of the constrained problem and keeps the
// matrices positive definite. Where the paper has one free scale alpha for the group that comes in, every node here has
// its own scale, spread evenly along the path like the rest of the drift (soft: equal at linked nodes; hard: the
// ties'), because a single camera's scale drifts as it goes.
PoseGraphSolution solve_path_graph(const PoseGraph& graph);

}  // namespace coslam
