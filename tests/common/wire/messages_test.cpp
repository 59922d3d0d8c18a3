// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The list of message types and its description for those who write foreign programs.
#include "common/wire/middleware.h"  // first: other orders are ambiguous in C++20

#include "common/wire/messages.h"

#include <gmock/gmock.h>

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "idl/coslamPubSubTypes.h"

namespace coslam::messages_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// The lines of the table of topics in idl/README.md, by topic.
std::map<std::string, std::string> described_topics() {
  std::ifstream file(COSLAM_IDL_README);
  std::map<std::string, std::string> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("| `coslam/")) rows[line.substr(3, line.find('`', 3) - 3)] = line;
  }
  return rows;
}

std::string qos_of(const Topic& topic) {
  std::string text = topic.reliable ? "reliable" : "best effort";
  text += topic.late_joiners ? ", transient local" : ", volatile";
  text += ", keep last " + std::to_string(topic.writer_depth);
  if (topic.paced) text += ", paced";
  if (topic.by_run) text += ", one partition a run";
  if (topic.sign_of_life) text += ", liveliness manual by topic 0.5 s";
  return text;
}

TEST(MessageTypes, AreDescribed) {
  std::map<std::string, std::string> rows = described_topics();
  for_each_message_type([&]<class M, class S, class V>(const MessageType<M, S, V>& type) {
    S serialiser;
    const std::string full_name = type_name(serialiser);
    EXPECT_THAT(full_name, StartsWith("coslam::idl::"));
    const std::string row = rows[type.topic.name];
    EXPECT_THAT(row, HasSubstr("| `" + full_name.substr(std::string("coslam::idl::").size()) + "` |"));
    EXPECT_THAT(row, HasSubstr(type.topic.way == Way::kUp ? "| up |" : "| down |"));
    EXPECT_THAT(row, HasSubstr("| " + qos_of(type.topic) + " |"));
    rows.erase(type.topic.name);
  });
  for (const auto& [topic, row] : rows) ADD_FAILURE() << topic << " is no topic: " << row;
}

// Bounds are literals, since not every generator reads a constant there.
TEST(MessageTypes, BoundsOfSequencesAreTheConstantsBesideThem) {
  std::ifstream file(COSLAM_IDL);
  const std::regex constant(R"(const unsigned long (\w+) = (\d+);.*)"),
      bound(R"(\s*sequence<.*, (\w+)> \w+;\s*// (MAX_\w+).*)");
  std::map<std::string, std::string> constants;
  int bounds = 0;
  std::smatch found;
  for (std::string line; std::getline(file, line);) {
    if (std::regex_match(line, found, constant)) constants[found[1]] = found[2];
    if (!std::regex_match(line, found, bound)) continue;
    EXPECT_EQ(found[1], constants[found[2]]) << line;
    ++bounds;
  }
  EXPECT_GE(bounds, 16);
}

TEST(MessageTypes, EachHasATopicOfItsOwn) {
  std::set<std::string> names;
  for (const Topic& topic : kTopics) names.insert(topic.name);
  EXPECT_EQ(names.size(), kTopicCount);
  EXPECT_STREQ(topic_of<idl::MapPatch>().name, "coslam/map");
  EXPECT_STREQ(kTopics[topic_index<idl::ServerStatus>()].name, "coslam/server");
}

TEST(MessageTypes, FramesAreReadBeforeWhatIsSaidAboutThem) {
  EXPECT_LT(topic_index<idl::TrackFrame>(), topic_index<idl::AgentStatus>());
  EXPECT_LT(topic_index<idl::PatchReply>(), topic_index<idl::AgentStatus>());
  EXPECT_LT(topic_index<idl::DescriptorReply>(), topic_index<idl::AgentStatus>());
}

}  // namespace
}  // namespace coslam::messages_test
