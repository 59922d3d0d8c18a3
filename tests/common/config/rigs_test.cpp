// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/rigs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/config/config.h"
#include "common/config/yaml_value.h"
#include "tests/support/matchers.h"
#include "tests/support/temp_folder.h"

namespace coslam::rigs_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kCamchain = R"(cam0:
  camera_model: pinhole
cam1:
  T_cn_cnm1:
  - [0.0, -1.0, 0.0, 0.1]
  - [1.0, 0.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
cam2:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, 0.0]
  - [0.0, 1.0, 0.0, 0.2]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
)";

struct Config {
  std::vector<std::string> rigs;
};
template <class V>
void describe(V& v, Config& c) {
  v.field("rigs", c.rigs, read_rig_texts, "cameras that are fixed to another");
}

class RigsInAFile : public testing::Test {
 protected:
  std::vector<std::string> load(const std::string& rigs) {
    Config config;
    config::load(config, folder_.write("server.yaml", "rigs:\n  - " + rigs + "\n"));
    return config.rigs;
  }
  std::string error(const std::string& rigs) {
    return test::error_of<UserError>([&] { load(rigs); });
  }
  test::TempFolder folder_;
};

TEST_F(RigsInAFile, AreSectionsAsInASequenceOrTexts) {
  EXPECT_THAT(load("{cameras: [a, b, c], cam_from_first: {b: [1, 0, 0, 0, 0, 0, 1], c: [0, 2, 0, 0, 0, 1, 0]}}"),
              ElementsAre("b a 1 0 0 0 0 0 1", "c a 0 2 0 0 0 1 0"));
  EXPECT_THAT(load("b a 1 0 0 0 0 0 1"), ElementsAre("b a 1 0 0 0 0 0 1"));
  EXPECT_THAT(load("b a 1 0 0 0 0 0 1\n  - {cameras: [c, d], cam_from_first: {d: [0, 0, 3, 0, 0, 0, 1]}}"),
              ElementsAre("b a 1 0 0 0 0 0 1", "d c 0 0 3 0 0 0 1"));
}

TEST_F(RigsInAFile, ComeFromACamchainOfKalibr) {
  folder_.write("camchain.yaml", kCamchain);
  const auto rigs = load("{cameras: [left, right, top], kalibr: camchain.yaml}");
  ASSERT_EQ(rigs.size(), 2U);
  const RigCamera right = parse_rig_camera(rigs[0]), top = parse_rig_camera(rigs[1]);
  const Rigid3 quarter(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())), {0.1, 0, 0});
  EXPECT_EQ(right.camera + " " + right.first + ", " + top.camera + " " + top.first, "right left, top left");
  EXPECT_THAT(right.cam_from_first, test::PoseNear(quarter, 1e-9, 1e-9));
  EXPECT_THAT(top.cam_from_first, test::PoseNear(Rigid3(quarter.rotation, {0.1, 0.2, 0}), 1e-9, 1e-9));
}

TEST_F(RigsInAFile, WhatIsWrongIsNamedWithItsLine) {
  EXPECT_THAT(error("{cameras: [a], cam_from_first: {}}"), HasSubstr("server.yaml:2: rigs[0].cameras: a rig has at"));
  EXPECT_THAT(error("{cameras: [a, a], cam_from_first: {}}"), HasSubstr("'a' is in the rig twice"));
  EXPECT_THAT(error("{cameras: [a, b]}"), HasSubstr("the key 'cam_from_first' is missing"));
  EXPECT_THAT(error("{cameras: [a, b], cam_from_first: {b: [1, 0, 0, 0, 0, 0, 2]}}"), HasSubstr("quaternion"));
  EXPECT_THAT(error("{cameras: [a, b], kalibr: nothing.yaml}"), HasSubstr("nothing.yaml does not exist"));
  folder_.write("camchain.yaml", kCamchain);
  EXPECT_THAT(error("{cameras: [a, b], kalibr: camchain.yaml, cam_from_first: {}}"), HasSubstr("either"));
  EXPECT_THAT(error("{cameras: [a, b, c, d], kalibr: camchain.yaml}"), HasSubstr("the key 'cam3' is missing"));
  folder_.write("bent.yaml", "cam1:\n  T_cn_cnm1: [[1, 0.2, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n");
  EXPECT_THAT(error("{cameras: [a, b], kalibr: bent.yaml}"),
              HasSubstr("bent.yaml:2: cam1.T_cn_cnm1: this is not a rotation"));
}

}  // namespace
}  // namespace coslam::rigs_test
