// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/metrics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <set>
#include <sstream>

namespace coslam::metrics_test {
namespace {

using ::testing::HasSubstr;

TEST(MetricsText, IsOfPrometheus) {
  MetricsText text;
  text.one("a_total", MetricsText::Kind::kCounter, "what it counts", 3);
  text.begin("b", MetricsText::Kind::kGauge, "a figure of each");
  text.value(0.5, {{"agent", "one \"quoted\\"}, {"side", "up"}});
  text.value(std::nan(""));
  EXPECT_EQ(text.take(),
            "# HELP a_total what it counts\n# TYPE a_total counter\na_total 3\n"
            "# HELP b a figure of each\n# TYPE b gauge\nb{agent=\"one \\\"quoted\\\\\",side=\"up\"} 0.5\nb NaN\n");
}

TEST(Metrics, CountEveryLoss) {
  PublicState state;
  state.loop.lost = {{"late_frames", 4}, {"sets_left_out", 2}};
  state.loop.rejected = {{"malformed", 7}};
  state.stages["frame_set"] = {.p50 = 10, .p95 = 20, .p99 = 30, .sum = 5000, .count = 400};
  PublicAgent agent;
  agent.facts.name = "cam0";
  agent.facts.bytes_up = 1234;
  agent.facts.images[ImageFate::kNotSent] = 5;
  state.agents.push_back(agent);
  MetricsText metrics;
  put_metrics(state, &metrics);
  const std::string text = metrics.take();
  for (const char* line :
       {"coslam_lost_total{what=\"late_frames\"} 4\n", "coslam_lost_total{what=\"sets_left_out\"} 2\n",
        "coslam_rejected_total{reason=\"malformed\"} 7\n",
        "coslam_agent_images_total{agent=\"cam0\",fate=\"not_sent\"} 5\n",
        "coslam_agent_bytes_total{agent=\"cam0\",direction=\"up\"} 1234\n",
        "coslam_stage_seconds{stage=\"frame_set\",quantile=\"0.5\"} 0.01\n",
        "coslam_stage_seconds_sum{stage=\"frame_set\"} 5\n", "coslam_stage_seconds_count{stage=\"frame_set\"} 400\n",
        "coslam_agent_clock_offset_seconds{agent=\"cam0\"} NaN\n"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
  // Each figure is declared once, before its values.
  std::istringstream lines(text);
  std::set<std::string> declared;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("# TYPE ")) continue;
    const std::string name = line.substr(7, line.find(' ', 7) - 7);
    EXPECT_TRUE(declared.insert(name).second) << name;
  }
}

}  // namespace
}  // namespace coslam::metrics_test
