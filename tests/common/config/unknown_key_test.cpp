// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/unknown_key.h"

#include <gmock/gmock.h>

namespace coslam::config::unknown_key_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::vector<std::string> kKnown = {"agents",
                                         "wire.domain",
                                         "wire.lease_s",
                                         "server.theta",
                                         "server.sigma_px",
                                         "server.sync.deadline_s",
                                         "server.localise.min_inliers",
                                         "server.localise.lost_after_s",
                                         "server.inter_pose.enabled",
                                         "server.inter_pose.min_inliers",
                                         "server.classify.enabled",
                                         "server.map_inter.inter_mapping_period",
                                         "server.refine.enabled",
                                         "server.refine.window",
                                         "server.clock.enabled",
                                         "server.clock.period"};

TEST(NearestKeys, SpellingOfOneStep) {
  EXPECT_THAT(nearest_keys("server.thetta", kKnown), ElementsAre("server.theta"));
  EXPECT_THAT(nearest_keys("sever.theta", kKnown), ElementsAre("server.theta"));
  EXPECT_THAT(nearest_keys("server.localize.min_inliers", kKnown), ElementsAre("server.localise.min_inliers"));
  EXPECT_THAT(nearest_keys("server.localize", kKnown), ElementsAre("server.localise"));
  EXPECT_THAT(nearest_keys("server.clock.periods", kKnown), ElementsAre("server.clock.period"));
  EXPECT_THAT(nearest_keys("server_theta", kKnown), ElementsAre("server.theta"));
}

TEST(NearestKeys, SpellingOfSeveralSteps) {
  EXPECT_THAT(nearest_keys("sever.localize.min_inlier", kKnown), ElementsAre("server.localise.min_inliers"));
  EXPECT_THAT(nearest_keys("servre.synk.dedline_s", kKnown), ElementsAre("server.sync.deadline_s"));
}

TEST(NearestKeys, RightNameInAnotherSection) {
  EXPECT_THAT(nearest_keys("theta", kKnown), ElementsAre("server.theta"));
  EXPECT_THAT(nearest_keys("server.map.theta", kKnown), ElementsAre("server.theta"));
  EXPECT_THAT(nearest_keys("server.map_inter.theta", kKnown), ElementsAre("server.theta"));
  EXPECT_THAT(nearest_keys("deadline_s", kKnown), ElementsAre("server.sync.deadline_s"));
  EXPECT_THAT(nearest_keys("sync.deadline_s", kKnown), ElementsAre("server.sync.deadline_s"));
  EXPECT_THAT(nearest_keys("wire.theta", kKnown), ElementsAre("server.theta"));
}

TEST(NearestKeys, SharedSectionsDecideBetweenEqualNames) {
  EXPECT_THAT(nearest_keys("localise.min_inliers", kKnown), ElementsAre("server.localise.min_inliers"));
  EXPECT_THAT(nearest_keys("localize.min_inliers", kKnown), ElementsAre("server.localise.min_inliers"));
  EXPECT_THAT(nearest_keys("min_inliers", kKnown),
              ElementsAre("server.localise.min_inliers", "server.inter_pose.min_inliers"));
  EXPECT_THAT(nearest_keys("server.enabled", kKnown),
              ElementsAre("server.inter_pose.enabled", "server.classify.enabled", "server.refine.enabled"));
}

TEST(NearestKeys, PartOfTheNameInItsOwnSectionGoesFirst) {
  EXPECT_THAT(nearest_keys("server.map_inter.period", kKnown), ElementsAre("server.map_inter.inter_mapping_period"));
}

TEST(NearestKeys, NothingNear) {
  EXPECT_THAT(nearest_keys("zzz", kKnown), IsEmpty());
  EXPECT_THAT(nearest_keys("server.localise.zzz", kKnown), IsEmpty());
  EXPECT_THAT(nearest_keys("", kKnown), IsEmpty());
  EXPECT_THAT(nearest_keys(".", kKnown), IsEmpty());
}

TEST(UnknownKey, ReasonsOfSet) {
  EXPECT_EQ(unknown_set_reason("theta", kKnown), "unknown key, did you mean 'server.theta'?");
  EXPECT_EQ(unknown_set_reason("min_inliers", kKnown),
            "unknown key, did you mean 'server.localise.min_inliers' or 'server.inter_pose.min_inliers'?");
  EXPECT_EQ(unknown_set_reason("server.enabled", kKnown),
            "unknown key, did you mean 'server.inter_pose.enabled', 'server.classify.enabled' or "
            "'server.refine.enabled'?");
  EXPECT_EQ(unknown_set_reason("wire", kKnown), "this is a section, its keys are domain lease_s");
  EXPECT_EQ(unknown_set_reason("zzz", kKnown), "unknown key, known are agents wire server");
  EXPECT_EQ(unknown_set_reason("server.clock.zzz", kKnown), "unknown key, known in server.clock are enabled period");
}

TEST(UnknownKey, ReasonsInFile) {
  EXPECT_EQ(unknown_file_key_reason("server.", "thetta", "", kKnown), "unknown key, did you mean 'theta'?");
  EXPECT_EQ(unknown_file_key_reason("", "theta", "", kKnown), "unknown key, did you mean 'server.theta'?");
  EXPECT_EQ(unknown_file_key_reason("server.", "map", "theta", kKnown), "unknown key, did you mean 'server.theta'?");
  EXPECT_EQ(unknown_file_key_reason("server.", "localize", "min_inliers", kKnown),
            "unknown key, did you mean 'localise'?");
  EXPECT_EQ(unknown_file_key_reason("server.", "localize", "zzz", kKnown), "unknown key, did you mean 'localise'?");
  EXPECT_EQ(unknown_file_key_reason("", "sever", "sync.deadline_s", kKnown), "unknown key, did you mean 'server'?");
  EXPECT_EQ(unknown_file_key_reason("", "sync", "deadline_s", kKnown),
            "unknown key, did you mean 'server.sync.deadline_s'?");
  EXPECT_EQ(unknown_file_key_reason("", "server.sync", "deadline_s", kKnown),
            "unknown key: in a file sections are nested, without dots");
  EXPECT_EQ(unknown_file_key_reason("server.clock.", "zzz", "", kKnown),
            "unknown key, known in server.clock are enabled period");
}

}  // namespace
}  // namespace coslam::config::unknown_key_test
