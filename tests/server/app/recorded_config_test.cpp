// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/recorded_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.h"
#include "common/base/log.h"

namespace coslam::recorded_config_test {
namespace {

TEST(RecordedConfig, SectionsAreFoundUnderTheirEarlierNames) {
  RecordingHead head;
  head.configuration = {{"agents", {"a", "b"}},
                        {"server",
                         {{"theta", 2.5},
                          {"refine", {{"at_end", "nothing"}}},
                          {"past", {{"whole_s", 75.0}}},
                          {"meet", {{"loops", false}, {"images_per_s", 0.25}}}}}};
  const RecordedConfig config = recorded_config(head, "old.rec");
  ServerConfig server = config.server;
  EXPECT_EQ(config.agents.size(), 2U);
  EXPECT_EQ(server.map.map.theta, 2.5);
  EXPECT_EQ(server.map.of<BundleAdjustmentConfig>().at_end, "nothing");
  EXPECT_EQ(server.map.of<ForgetConfig>().whole_s, 75);
  EXPECT_FALSE(server.map.of<PlaceRecognitionConfig>().loops);
  EXPECT_EQ(server.map.of<AskConfig>().images_per_s, 0.25);
}

TEST(RecordedConfig, SettingsThatAreConstantsNowAreLeftOut) {
  RecordingHead head;
  head.configuration = {{"server",
                         {{"map_intra", {{"min_track_s", 2.0}, {"early_parallax_rad", 0.04}}},
                          {"window_pose", {{"free_s", 0.4}, {"seen_s", 4.0}}}}}};
  EXPECT_EQ(recorded_config(head, "old.rec").server.map.of<MapIntraConfig>().early_parallax_rad, 0.04);
  EXPECT_THAT(warnings_given(), testing::IsEmpty());
  head.configuration = {{"server", {{"objects", {{"min_path_s", 0.5}}}}}};
  recorded_config(head, "old.rec");
  ASSERT_EQ(warnings_given().size(), 1U);
  EXPECT_THAT(warnings_given().front().text,
              testing::HasSubstr("server.objects.min_path_s = 0.5, which is no setting any more: the replay has 0.2"));
}

TEST(RecordedConfig, WhatItHoldsNowIsReadAsItIs) {
  RecordedConfig config;
  config.server.map.of<ForgetConfig>().whole_s = 90;
  RecordedConfig read = recorded_config(recording_head(RunId(7), config), "new.rec");
  EXPECT_EQ(read.server.map.of<ForgetConfig>().whole_s, 90);
}

TEST(RecordedConfig, AnUnknownSectionIsRefused) {
  RecordingHead head;
  head.configuration = {{"server", {{"nonsense", {{"a", 1}}}}}};
  EXPECT_THROW(recorded_config(head, "bad.rec"), UserError);
}

}  // namespace
}  // namespace coslam::recorded_config_test
