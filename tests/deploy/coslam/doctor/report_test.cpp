// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/report.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace coslam::doctor::report_test {
namespace {

const Findings kSome = {{Grade::kOk, "eth0", "10.0.0.5, MTU 1500"},
                        {Grade::kWarn, "buffers", "too small", "sysctl"},
                        {Grade::kFail, "key", "open to others", "chmod 600 KEY"},
                        {Grade::kFail, "disk", "full", "--out DIR"}};

TEST(DoctorReport, ALineEachAndWhatToSeeToFirst) {
  EXPECT_EQ(text_of(kSome),
            "ok    eth0     10.0.0.5, MTU 1500\n"
            "warn  buffers  too small -> sysctl\n"
            "FAIL  key      open to others -> chmod 600 KEY\n"
            "FAIL  disk     full -> --out DIR\n"
            "2 faults, 1 warning. First: key: open to others -> chmod 600 KEY\n");
  EXPECT_EQ(text_of({kSome[0]}), "ok    eth0  10.0.0.5, MTU 1500\nAll is fine.\n");
  EXPECT_EQ(text_of({kSome[1]}),
            "warn  buffers  too small -> sysctl\n0 faults, 1 warning. First: buffers: too small -> sysctl\n");
}

TEST(DoctorReport, Json) {
  const auto json = nlohmann::json::parse(json_of(kSome));
  EXPECT_EQ(json["verdict"], "FAIL");
  ASSERT_EQ(json["findings"].size(), 4U);
  EXPECT_EQ(json["findings"][1]["grade"], "warn");
  EXPECT_EQ(json["findings"][1]["subject"], "buffers");
  EXPECT_EQ(json["findings"][1]["found"], "too small");
  EXPECT_EQ(json["findings"][1]["mend"], "sysctl");
  EXPECT_EQ(nlohmann::json::parse(json_of({}))["verdict"], "ok");
}

}  // namespace
}  // namespace coslam::doctor::report_test
