// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/config.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::config_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct TrackerConfig {
  int max_tracks = 300;
  double min_quality = 0.01;
  friend bool operator==(const TrackerConfig&, const TrackerConfig&) = default;
};
template <class V>
void describe(V& v, TrackerConfig& c) {
  v.field("max_tracks", c.max_tracks, {20, 4000}, "features followed at once");
  v.field("min_quality", c.min_quality, {0, 1}, "of a corner, relative to the best");
}

struct AgentConfig {
  TrackerConfig tracker;
  bool verbose = false;
  friend bool operator==(const AgentConfig&, const AgentConfig&) = default;
};
template <class V>
void describe(V& v, AgentConfig& c) {
  v.section("tracker", c.tracker);
  v.field("verbose", c.verbose, "log more");
}

struct RunConfig {
  std::string out = "result";
  std::string rate = "max";
  std::vector<std::string> peers;
  AgentConfig agent;
  friend bool operator==(const RunConfig&, const RunConfig&) = default;
};
template <class V>
void describe(V& v, RunConfig& c) {
  v.field("out", c.out, "result folder");
  v.field("rate", c.rate, {"max", "live"}, "pacing");
  v.field("peers", c.peers, "addresses");
  v.section("agent", c.agent);
}

class Config : public ::testing::Test {
 protected:
  std::string load_error(const std::string& text) {
    return test::error_of<UserError>([&] { config::load(config_, folder_.write("run.yaml", text)); });
  }
  std::string set_error(const std::string& assignment) {
    return test::error_of<UsageError>([&] { config::apply_set(config_, assignment); });
  }
  test::TempFolder folder_;
  RunConfig config_;
};

TEST_F(Config, FileOverDefaultAndSetOverFile) {
  EXPECT_EQ(load_error("agent:\n  tracker: {max_tracks: 500, min_quality: 0.5}\npeers: [a, b]\nout: x y\n"), "");
  EXPECT_EQ(config_.agent.tracker.max_tracks, 500);
  EXPECT_EQ(config_.agent.tracker.min_quality, 0.5);
  EXPECT_EQ(config_.out, "x y");
  EXPECT_THAT(config_.peers, ElementsAre("a", "b"));
  EXPECT_EQ(config_.rate, "max");

  EXPECT_EQ(set_error("agent.tracker.max_tracks=200"), "");
  EXPECT_EQ(set_error("agent.verbose=true"), "");
  EXPECT_EQ(set_error("peers = c, d"), "");
  EXPECT_EQ(set_error("out=a=b"), "");
  EXPECT_EQ(config_.agent.tracker.max_tracks, 200);
  EXPECT_EQ(config_.agent.tracker.min_quality, 0.5);
  EXPECT_TRUE(config_.agent.verbose);
  EXPECT_THAT(config_.peers, ElementsAre("c", "d"));
  EXPECT_EQ(config_.out, "a=b");
}

TEST_F(Config, ADumpIsReadBackFromItsText) {
  config_.out = "a \"quoted\"\n: #path";
  config_.agent.tracker.min_quality = 0.1234567890123456;
  config_.peers = {"a", "b c"};
  RunConfig again;
  config::load_text(again, config::dump_json(config_).dump(), "a.rec");
  EXPECT_EQ(again, config_);
  const auto wrong = test::error_of<UserError>([&] { config::load_text(again, R"({"agnet": {}})", "a.rec"); });
  EXPECT_THAT(wrong, HasSubstr("a.rec:1: agnet: unknown key"));
}

TEST_F(Config, EmptySectionsKeepDefaults) {
  EXPECT_EQ(load_error("agent:\nout: x\n"), "");
  EXPECT_EQ(config_.agent, AgentConfig());
}

TEST_F(Config, FileErrorsNameFileLineKeyPathAndReason) {
  EXPECT_THAT(load_error("agent:\n  tracker:\n    max_track: 5\n"),
              HasSubstr("run.yaml:3: agent.tracker.max_track: unknown key, did you mean 'max_tracks'?"));
  EXPECT_THAT(load_error("agnet: {}\n"), HasSubstr("run.yaml:1: agnet: unknown key, did you mean 'agent'?"));
  EXPECT_THAT(load_error("zzz: 1\n"), HasSubstr("known are out rate peers agent"));
  EXPECT_THAT(load_error("out: x\nmin_quality: 0.5\n"),
              HasSubstr("run.yaml:2: min_quality: unknown key, did you mean 'agent.tracker.min_quality'?"));
  EXPECT_THAT(load_error("agent.verbose: true\n"),
              HasSubstr("agent.verbose: unknown key: in a file sections are nested"));
  EXPECT_THAT(load_error("agent: {tracker: {max_tracks: 5}}\n"),
              HasSubstr("agent.tracker.max_tracks: '5' is outside 20 to 4000"));
  EXPECT_THAT(load_error("agent: {tracker: {max_tracks: 50.5}}\n"), HasSubstr("'50.5' is not a whole number"));
  EXPECT_THAT(load_error("agent: {tracker: {min_quality: .nan}}\n"), HasSubstr("'.nan' is not a number"));
  EXPECT_THAT(load_error("agent: {verbose: maybe}\n"), HasSubstr("agent.verbose: 'maybe' is neither true nor false"));
  EXPECT_THAT(load_error("rate: slow\n"), HasSubstr("rate: 'slow' is none of max, live"));
  EXPECT_THAT(load_error("peers: a\n"), HasSubstr("peers: a list is expected"));
  EXPECT_THAT(load_error("out: [a]\n"), HasSubstr("out: a text is expected"));
  EXPECT_THAT(load_error("agent: 5\n"), HasSubstr("agent: a section (key: value) is expected"));
  EXPECT_EQ(config_, RunConfig());
}

TEST_F(Config, SetErrorsNameTheAssignment) {
  EXPECT_THAT(set_error("agent.tracker.max_track=5"),
              HasSubstr("--set agent.tracker.max_track=5: unknown key, did you mean 'agent.tracker.max_tracks'?"));
  EXPECT_THAT(set_error("agent.tracker.max_tracks"), HasSubstr("key=value is expected"));
  EXPECT_THAT(set_error("agent.tracker.max_tracks=99999999999"), HasSubstr("is outside 20 to 4000"));
  EXPECT_THAT(set_error("agent.tracker=5"),
              HasSubstr("--set agent.tracker=5: this is a section, its keys are max_tracks min_quality"));
  EXPECT_THAT(set_error("agent.tracker.zzz=5"), HasSubstr("known in agent.tracker are max_tracks min_quality"));
}

TEST_F(Config, DumpsWhatIsInEffect) {
  config_.peers = {"a", "b"};
  config_.agent.tracker.min_quality = 0.1;
  const auto json = config::dump_json(config_);
  EXPECT_EQ(json["agent"]["tracker"]["max_tracks"], 300);
  EXPECT_EQ(json["agent"]["tracker"]["min_quality"], 0.1);
  EXPECT_EQ(json["agent"]["verbose"], false);
  EXPECT_EQ(json["peers"].size(), 2u);

  EXPECT_EQ(config::dump_yaml(config_),
            "out: \"result\"  # result folder\n"
            "rate: \"max\"  # pacing (max, live)\n"
            "peers: [\"a\", \"b\"]  # addresses\n"
            "agent:\n"
            "  tracker:\n"
            "    max_tracks: 300  # features followed at once (20 to 4000)\n"
            "    min_quality: 0.1  # of a corner, relative to the best (0 to 1)\n"
            "  verbose: false  # log more\n");
}

TEST_F(Config, DumpReadsBackToTheSameTexts) {
  const std::vector<std::string> texts = {"",
                                          " ",
                                          "1",
                                          "1.0",
                                          "true",
                                          "null",
                                          "~",
                                          "no",
                                          "a: b",
                                          "a #b",
                                          "- a",
                                          "[a, b]",
                                          "{a: b}",
                                          "*a",
                                          "&a",
                                          "!a",
                                          "%a",
                                          "@a",
                                          "'a'",
                                          "\"a\"",
                                          "a\\nb",
                                          "\\",
                                          "a\nb",
                                          "a\tb\r",
                                          "\x01\x7f",
                                          "...",
                                          "---",
                                          "a,b",
                                          "\xc3\xa9 \xe2\x82\xac",
                                          "\xe9",
                                          "v4l2:0",
                                          "gst:a ! b name=\"c\"",
                                          "key: \"value\" # not a comment"};
  for (const std::string& text : texts) {
    config_.out = text;
    config_.peers = {text, "plain", text};
    RunConfig read;
    config::load(read, folder_.write("dump.yaml", config::dump_yaml(config_)));
    EXPECT_EQ(read, config_) << text << "\n" << config::dump_yaml(config_);
  }
}

TEST_F(Config, ListIsSetWithAndWithoutBrackets) {
  for (const std::string text : {"10.0.0.1,10.0.0.2", "10.0.0.1, 10.0.0.2", "[10.0.0.1,10.0.0.2]",
                                 " [ 10.0.0.1, 10.0.0.2 ]", "[\"10.0.0.1\", '10.0.0.2']"}) {
    config::apply_set(config_, "peers=" + text);
    EXPECT_EQ(config_.peers, (std::vector<std::string>{"10.0.0.1", "10.0.0.2"})) << text;
  }
  config::apply_set(config_, "peers=[]");
  EXPECT_TRUE(config_.peers.empty());
  EXPECT_THAT(set_error("peers=[10.0.0.1"), HasSubstr("is not a list"));
}

TEST_F(Config, DumpReadsBackToTheSameNumbers) {
  for (const double number : {0.0, 1.0, 0.1, 1e-5, 1.0 / 3, 0.1 + 0.2, 5e-324, 2.2250738585072014e-308, 0.02}) {
    config_.agent.tracker.min_quality = number;
    RunConfig read;
    config::load(read, folder_.write("dump.yaml", config::dump_yaml(config_)));
    EXPECT_EQ(read.agent.tracker.min_quality, number);
  }
  config_.agent.tracker.min_quality = 0.1 + 0.2;
  EXPECT_THAT(config::dump_yaml(config_), HasSubstr("min_quality: 0.30000000000000004  #"));
}

struct WideConfig {
  int count = 1234567;
  double period_s = 1e9;
};
template <class V>
void describe(V& v, WideConfig& c) {
  v.field("count", c.count, {-1000000, 2147483647}, "");
  v.field("period_s", c.period_s, {0.0123456789, 1e9}, "seconds");
}

TEST(ConfigDump, SaysBoundsInFull) {
  const std::string yaml = config::dump_yaml(WideConfig());
  EXPECT_THAT(yaml, HasSubstr("count: 1234567  # (-1000000 to 2147483647)\n"));
  EXPECT_THAT(yaml, HasSubstr("period_s: 1e+09  # seconds (0.0123456789 to 1e+09)\n"));
}

struct TwiceConfig {
  int a = 1;
};
template <class V>
void describe(V& v, TwiceConfig& c) {
  v.field("a", c.a, {0, 1}, "");
  v.field("a", c.a, {0, 1}, "");
}
struct OutsideConfig {
  int a = 5;
};
template <class V>
void describe(V& v, OutsideConfig& c) {
  v.field("a", c.a, {0, 1}, "");
}

TEST(ConfigDeathTest, WrongDeclarationsAreBugs) {
  TwiceConfig twice;
  OutsideConfig outside;
  EXPECT_DEATH(config::fields_of(twice), "declared twice");
  EXPECT_DEATH(config::fields_of(outside), "outside its bounds");
}

}  // namespace
}  // namespace coslam::config_test
