// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "tests/support/sim_map.h"

namespace coslam::test {

// Map of two cameras side by side, with a world point that both follow.
class SharedPointTest : public testing::Test {
 protected:
  explicit SharedPointTest(bool patches) {
    sim_.advance(6, patches);
    while (!sim_.all_follow(shared_)) ++shared_;
  }
  const ServerTrack& track(CameraId id) const { return *sim_.track_of(id, shared_); }

  const SimWorld world_{{.points = 100}};
  SimMap sim_{world_, paths_side_by_side(2)};
  MapEdit& edit_ = sim_.edit;
  int shared_ = 0;
};

}  // namespace coslam::test
