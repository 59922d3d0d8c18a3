// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/rates.h"

#include <gtest/gtest.h>

namespace coslam::rates_test {
namespace {

struct Sums {
  double t_s = 0;
  std::uint64_t up = 0;
  std::uint32_t due = 0, used = 0, dropped = 0;
};

PublicState state(const Sums& sums, RunId run = RunId(1)) {
  PublicState out;
  out.wall_ns = to_ns(sums.t_s);
  PublicAgent agent;
  agent.facts.name = "cam0";
  agent.run = run;
  agent.facts.bytes_up = sums.up;
  agent.facts.status.dropped = sums.dropped;
  agent.frames_due = sums.due;
  agent.frames_used = sums.used;
  out.agents.push_back(agent);
  return out;
}

TEST(Rates, AreOfTheLastSeconds) {
  Rates rates;
  for (int t = 0; t <= 20; ++t) {
    const auto up = static_cast<std::uint64_t>(t < 10 ? 1000 * t : 10000 + 5000 * (t - 10));
    rates.see(state({.t_s = 1.0 * t, .up = up}));
  }
  EXPECT_NEAR(rates.rate_of("cam0").bytes_up_per_s, 5000, 1);
  EXPECT_EQ(rates.rate_of("cam0").bytes_down_per_s, 0);
  EXPECT_EQ(rates.rate_of("nobody").bytes_up_per_s, 0);
}

TEST(Rates, ImagesThatAnAgentHadNoTimeForAreNotLost) {
  Rates rates;
  rates.see(state({.t_s = 0, .due = 10, .used = 10}));
  rates.see(state({.t_s = 5, .due = 110, .used = 80, .dropped = 20}));
  EXPECT_NEAR(rates.rate_of("cam0").lost_percent, 100.0 * 10 / 80, 1e-9) << "100 taken, 20 dropped, 70 came";
}

TEST(Rates, BeginAnewWithARestart) {
  Rates rates;
  rates.see(state({.t_s = 0, .due = 1000, .used = 900}));
  rates.see(state({.t_s = 1, .due = 5, .used = 5}, RunId(2)));
  rates.see(state({.t_s = 2, .due = 35, .used = 35}, RunId(2)));
  EXPECT_EQ(rates.rate_of("cam0").lost_percent, 0);
}

TEST(Rates, TheTimeOfAFrameSetIsThatOfTheNewestOnes) {
  Rates rates;
  for (int t = 0; t < 20; ++t) {
    PublicState s = state({.t_s = 1.0 * t});
    s.stages["frame_set"] = {.sum = t < 10 ? 300.0 * t : 3000.0 + 600 * (t - 10),
                             .count = static_cast<std::uint64_t>(30 * t)};
    rates.see(s);
  }
  EXPECT_NEAR(rates.ms_per_set(), 20, 1e-9);
}

}  // namespace
}  // namespace coslam::rates_test
