// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/recorded_topic.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::recorded_topic_test {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

const recording::Topic kLeft{"/left/image_raw", "sensor_msgs/msg/Image", "cdr"};
const recording::Topic kRight{"/right/image_raw", "sensor_msgs/Image", "ros1"};
const recording::Topic kLens{"/left/camera_info", "sensor_msgs/msg/CameraInfo", "cdr"};
const recording::Topic kWords{"/words", "std_msgs/msg/String", "cdr"};
const recording::Topic kTheora{"/left/theora", "theora_image_transport/msg/Packet", "cdr"};
const recording::Topic kOwnForm{"/front/image", "sensor_msgs/msg/Image", "ros2"};
const recording::Topic kNothingKnown{"/odd", "", ""};

// Of topics without messages.
class Topics : public recording::Recording {
 public:
  explicit Topics(std::vector<recording::Topic> topics) : topics_(std::move(topics)) {}
  const std::vector<recording::Topic>& topics() const override { return topics_; }
  TimeNs first_ns() const override { return 0; }
  const std::string& warning() const override { return warning_; }
  void play(std::size_t) override {}
  std::optional<recording::Message> next() override { return std::nullopt; }

 private:
  std::vector<recording::Topic> topics_;
  std::string warning_;
};

std::string error_of_finding(const std::vector<recording::Topic>& topics, const std::string& name, Wanted wanted) {
  return test::error_of<UserError>([&] { find_topic(Topics(topics), {"bag:", "walk.mcap", name}, wanted); });
}

TEST(RecordedTopic, IsToldByTheBeginningOfItsName) {
  EXPECT_TRUE(names_recorded_topic("bag:a.bag"));
  EXPECT_TRUE(names_recorded_topic("mcap:/tmp/a.mcap#/left"));
  for (const char* name : {"", "bag", "a.bag", "BAG:a", "ros2:/left", "/bag:a"}) {
    EXPECT_FALSE(names_recorded_topic(name)) << name;
  }
}

TEST(RecordedTopic, HasAPathAndATopic) {
  const RecordedTopic topic = recorded_topic("bag:walk.bag#/left/image_raw", "/data");
  EXPECT_EQ(topic.scheme, "bag:");
  EXPECT_EQ(topic.path, "/data/walk.bag");
  EXPECT_EQ(topic.topic, "/left/image_raw");
  EXPECT_EQ(topic.name(), "bag:/data/walk.bag#/left/image_raw");
  EXPECT_EQ(recorded_topic("mcap:/far/walk.mcap", "/data").path, "/far/walk.mcap") << "it is absolute";
  EXPECT_EQ(recorded_topic("mcap:walk.mcap").topic, "");
  EXPECT_EQ(recorded_topic("mcap:walk.mcap#").topic, "");
}

TEST(RecordedTopic, ItsNameIsReadBack) {
  for (const char* name : {"bag:/a/b.bag", "mcap:/a/b#1.mcap#/c", "bag:/a b.bag#/c"}) {
    const RecordedTopic topic = recorded_topic(name);
    EXPECT_EQ(topic.name(), name);
    EXPECT_EQ(recorded_topic(topic.name()).topic, topic.topic);
  }
}

TEST(RecordedTopic, AMarkInANameOfAFileThatIsThereIsNoTopic) {
  const test::TempFolder folder;
  folder.write("walk#2.mcap", "");
  EXPECT_EQ(recorded_topic("mcap:walk#2.mcap", folder.path()).path, folder / "walk#2.mcap");
  EXPECT_EQ(recorded_topic("mcap:walk#2.mcap", folder.path()).topic, "");
  EXPECT_EQ(recorded_topic("mcap:walk#2.mcap#/left", folder.path()).topic, "/left");
  EXPECT_EQ(recorded_topic("walk#3.mcap", folder.path()).path, folder / "walk#3.mcap") << "a path alone has no topic";
}

TEST(FindTopic, TakesTheOneThatIsNamedOrTheOnlyOne) {
  const Topics both({kWords, kLeft, kLens, kRight});
  EXPECT_EQ(find_topic(both, {"bag:", "a", kRight.name}, Wanted::kImages), 3U);
  EXPECT_EQ(find_topic(both, {"bag:", "a", ""}, Wanted::kLenses), 2U);
  EXPECT_EQ(find_topic(Topics({kWords, kLeft, kLens}), {"bag:", "a", ""}, Wanted::kImages), 1U);
}

TEST(FindTopic, ListsWhatThereIsWhereNoneOrSeveralFit) {
  EXPECT_EQ(error_of_finding({kLeft, kLens, kRight}, "", Wanted::kImages),
            "walk.mcap: no topic is named (bag:PATH#TOPIC) of images; of these there are: /left/image_raw, "
            "/right/image_raw");
  EXPECT_EQ(error_of_finding({kLeft, kLens}, "/front", Wanted::kImages),
            "walk.mcap: there is no topic /front of images; of these there are: /left/image_raw");
  EXPECT_THAT(error_of_finding({kLeft}, "", Wanted::kLenses),
              HasSubstr("of lenses (CameraInfo); of these there are: none"));
  EXPECT_THAT(error_of_finding({}, "/left", Wanted::kImages), EndsWith("of these there are: none"));
}

TEST(FindTopic, ATopicOfTheOtherKindIsSaidToBeThereInAnotherForm) {
  EXPECT_THAT(error_of_finding({kLens}, kLens.name, Wanted::kImages),
              HasSubstr("not in a form that is read: /left/camera_info (sensor_msgs/msg/CameraInfo in cdr)"));
  EXPECT_THAT(error_of_finding({kWords}, "", Wanted::kImages), Not(HasSubstr("/words"))) << "it is no image at all";
  EXPECT_THAT(error_of_finding({kWords}, "/words", Wanted::kImages), HasSubstr("/words (std_msgs/msg/String in cdr)"));
}

TEST(FindTopic, SaysWhatMakesAFormReadable) {
  const std::string error = error_of_finding({kTheora, kOwnForm, kNothingKnown}, "/odd", Wanted::kImages);
  EXPECT_THAT(error, AllOf(HasSubstr("ros2 run image_transport republish theora raw"),
                           HasSubstr("/front/image (sensor_msgs/msg/Image in ros2): ros2 bag convert writes it as cdr"),
                           HasSubstr("/odd (no type in no encoding)")));
}

}  // namespace
}  // namespace coslam::recorded_topic_test
