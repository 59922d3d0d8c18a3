// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/other_lenses.h"

#include <gtest/gtest.h>

#include "common/dataset/result.h"
#include "common/dataset/result_folder.h"
#include "tests/support/temp_folder.h"

namespace coslam::other_lenses_test {
namespace {

TEST(OtherLensesTest, LeavesAsideWhatTheImagesDoNotFit) {
  const test::TempFolder folder;
  Sequence sequence;
  for (const char* name : {"right", "near", "double", "none"}) {
    sequence.agents.push_back({.name = name, .source = name, .calibration = std::string(name) + ".yaml"});
  }
  sequence.agents.back().calibration.clear();
  EXPECT_FALSE(leave_other_lenses(&sequence, folder / "result")) << "there is no report";
  const auto lens = [](double ratio) { return nlohmann::ordered_json{{"lens", {{"focal_ratio", ratio}}}}; };
  write_json(ResultFolder(folder / "result").report(),
             {{"agents", {{"right", lens(1.002)}, {"near", lens(0.85)}, {"double", lens(0.58)}, {"none", lens(0.7)}}}});
  EXPECT_TRUE(leave_other_lenses(&sequence, folder / "result"));
  EXPECT_EQ(sequence.agents[0].calibration, "right.yaml");
  EXPECT_EQ(sequence.agents[1].calibration, "near.yaml");
  EXPECT_TRUE(sequence.agents[2].calibration.empty());
  EXPECT_FALSE(leave_other_lenses(&sequence, folder / "result")) << "once";
}

}  // namespace
}  // namespace coslam::other_lenses_test
