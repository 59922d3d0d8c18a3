// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Live topics over the real middleware, through the loopback device. Nodes made with another DDS are in tests/interop.
#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "agent/capture/ros2_topic.h"
#include "agent/capture/source.h"
#include "common/base/error.h"
#include "common/ros/cdr.h"
#include "common/ros/convert.h"
#include "common/ros/sensor_messages.h"
#include "common/ros/type.h"
#include "common/wire/octet_topic.h"
#include "common/wire/ros_domain.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_domain.h"

namespace coslam::ros2_source_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr TimeNs kMs_ns = 1'000'000;
constexpr TimeNs kLater_ns = 1'000'000 * kMs_ns;  // than what a node says by itself

ros::Image image_of(TimeNs stamp_ns, std::uint32_t width, std::uint32_t height, std::uint8_t grey) {
  const ros::Header header{ros::time_of(stamp_ns), "camera"};
  return {header, height, width, "mono8", 0, width, std::vector<std::uint8_t>(width * height, grey)};
}

// A camera's node that says images of 8x6, one a millisecond of their stamps, until it is told what to say.
class Node {
 public:
  explicit Node(int domain) : participant_(ros_wire(domain), "node") {}

  void fall_silent() { speaker_ = {}; }
  void say(const ros::Image& image) { say_octets(ros::to_cdr(image)); }
  void say_octets(const std::vector<std::uint8_t>& octets) { EXPECT_TRUE(writer_.write(octets)); }

 private:
  Participant participant_;
  OctetWriter writer_{participant_, {"rt/image", ros::type_text<ros::Image>().dds_name, true, false, 50}};
  std::jthread speaker_{[this](const std::stop_token& stop) {
    for (TimeNs at_ns = kMs_ns; !stop.stop_requested(); at_ns += kMs_ns) {
      say(image_of(at_ns, 8, 6, 100));
      std::this_thread::sleep_for(5ms);  // its rate
    }
  }};
};

class LiveTopics : public testing::Test {
 protected:
  std::string name() const { return "ros2:/image?domain=" + std::to_string(domain_.number()); }
  struct Heard {
    TimeNs after_ns = 0;  // kLater_ns
    ImageFault fault = ImageFault::kNone;
    friend bool operator==(const Heard&, const Heard&) = default;
  };
  // So many images of a source that is open, after those that the node said by itself.
  static std::vector<Heard> later(ImageSource& source, std::size_t count) {
    std::vector<Heard> heard;
    while (heard.size() < count) {
      const auto image = source.next();
      if (!image) break;
      if (image->capture_ns >= kLater_ns) heard.push_back({image->capture_ns - kLater_ns, image->fault});
    }
    return heard;
  }

  const test::TestDomain domain_;
  Node node_{domain_.number()};
};

TEST_F(LiveTopics, ImagesHaveTheStampsOfTheirMessages) {
  const auto source = open_source(name(), {.width_px = 8, .height_px = 6});
  EXPECT_TRUE(source->live());
  TimeNs last_ns = 0;
  for (std::uint32_t i = 0; i < 20; ++i) {
    const auto image = source->next();
    ASSERT_TRUE(image);
    EXPECT_EQ(image->frame, FrameId(i));
    EXPECT_EQ(image->capture_ns % kMs_ns, 0);
    EXPECT_GT(image->capture_ns, last_ns);
    EXPECT_EQ(image->grey.at<uchar>(5, 7), 100);
    last_ns = image->capture_ns;
  }
}

TEST_F(LiveTopics, WhatHasAnotherSizeIsAFault) {
  const auto source = open_source(name(), {});
  node_.fall_silent();
  node_.say(image_of(kLater_ns + 1, 8, 6, 1));
  node_.say(image_of(kLater_ns + 2, 6, 8, 1));
  node_.say(image_of(kLater_ns + 3, 8, 6, 1));
  EXPECT_EQ(later(*source, 3), (std::vector<Heard>{{1}, {2, ImageFault::kResized}, {3}}));
}

TEST_F(LiveTopics, WhatIsDamagedIsAFault) {
  const auto source = open_source(name(), {});
  node_.fall_silent();
  const std::vector<std::uint8_t> whole = ros::to_cdr(image_of(kLater_ns + 1, 8, 6, 1));
  node_.say_octets({whole.begin(), whole.end() - 10});
  node_.say_octets({whole.begin(), whole.begin() + 6});
  node_.say_octets(whole);
  const std::vector<Heard> heard = later(*source, 3);
  ASSERT_EQ(heard.size(), 3U);
  EXPECT_EQ(heard[0].fault, ImageFault::kUnreadable);
  EXPECT_EQ(heard[1].fault, ImageFault::kUnreadable);
  EXPECT_EQ(heard[2], (Heard{1, ImageFault::kNone})) << "the arrival of what is damaged is no stamp";
}

TEST_F(LiveTopics, StampsOnlyGoForward) {
  const auto source = open_source(name(), {});
  node_.fall_silent();
  for (const TimeNs stamp : {5, 5, 4, 6}) node_.say(image_of(kLater_ns + stamp, 8, 6, 1));
  EXPECT_EQ(later(*source, 2), (std::vector<Heard>{{5}, {6}}));
  EXPECT_EQ(source->undated(), 2U);
}

TEST_F(LiveTopics, ADurationEndsWithoutFurtherImages) {
  const auto source = open_source(name(), {.duration_s = 0.2});
  node_.fall_silent();
  while (source->next()) {
  }
}

TEST_F(LiveTopics, AFormThatIsNoneIsNamed) {
  for (const char* wrong : {"ros2:", "ros2:image", "ros2:/image?domain=233", "ros2:/image?rate=3"}) {
    EXPECT_THAT(test::error_of<UserError>([&] { open_source(wrong, {}); }), HasSubstr(wrong));
  }
}

TEST(Ros2Domain, IsThatOfTheNameOrOfTheVariable) {
  unsetenv("ROS_DOMAIN_ID");
  EXPECT_EQ(ros2_domain("v4l2:0"), std::nullopt);
  EXPECT_EQ(ros2_domain(""), std::nullopt);
  EXPECT_EQ(ros2_domain("ros2:/image"), 0);
  setenv("ROS_DOMAIN_ID", "7", 1);
  EXPECT_EQ(ros2_domain("ros2:/image"), 7);
  EXPECT_EQ(ros2_domain("ros2:/image?domain=9"), 9);
  unsetenv("ROS_DOMAIN_ID");
}

}  // namespace
}  // namespace coslam::ros2_source_test
