// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/live_topic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::live_topic_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(LiveTopic, HasTheLoopbackDeviceAndNoDomainOfItsOwn) {
  const LiveTopic topic = live_topic("ros2:/left/image_raw");
  EXPECT_EQ(topic.topic, "/left/image_raw");
  EXPECT_EQ(topic.domain, std::nullopt);
  EXPECT_THAT(topic.interfaces, ElementsAre("127.0.0.1"));
}

TEST(LiveTopic, MayNameBoth) {
  const LiveTopic topic = live_topic("ros2:/a?domain=232&interface=10.0.0.5");
  EXPECT_EQ(topic.topic, "/a");
  EXPECT_EQ(topic.domain, 232);
  EXPECT_THAT(topic.interfaces, ElementsAre("10.0.0.5"));
  EXPECT_EQ(live_topic("ros2:/a?interface=10.0.0.5&domain=0").domain, 0);
}

TEST(LiveTopic, OtherFormsAreNamed) {
  for (const char* name :
       {"ros2:", "ros2:/", "ros2:a", "ros2:/a/", "ros2:?domain=1", "ros2:/a?domain=", "ros2:/a?domain=x",
        "ros2:/a?domain=233", "ros2:/a?domain=-1", "ros2:/a?interface=", "ros2:/a?&", "ros2:/a?domain"}) {
    EXPECT_THAT(test::error_of<UserError>([&] { live_topic(name); }), HasSubstr("'" + std::string(name) + "'")) << name;
  }
}

}  // namespace
}  // namespace coslam::live_topic_test
