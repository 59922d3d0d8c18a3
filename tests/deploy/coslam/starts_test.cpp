// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/starts.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "common/dataset/result.h"
#include "common/dataset/result_folder.h"
#include "tests/support/temp_folder.h"
#include "tests/support/world_sound.h"

namespace coslam::starts_test {
namespace {

constexpr int kRate_hz = 16000;

class StartsTest : public testing::Test {
 protected:
  SequenceAgent film(const std::string& name, double from_s, bool with_sound = true) {
    const auto file = folder_ / (name + ".mov");
    test::write_film(file, with_sound ? test::heard(kRate_hz, from_s, 5, 1 + films_) : std::vector<float>(), kRate_hz);
    return {.name = name, .source = file.string(), .start_is_open = films_++ > 0};
  }
  // The report of a run that found this lag of the second agent against the first.
  void report(double lag_s) {
    nlohmann::ordered_json report;
    for (const SequenceAgent& a : sequence_.agents) report["agents"][a.name]["lag"] = nullptr;
    report["agents"]["b"]["lag"] = {{"lag_s", lag_s}, {"against", "a"}};
    write_json(ResultFolder(result_).report(), report);
  }
  double start_s(const std::string& name) const {
    return std::ranges::find(sequence_.agents, name, &SequenceAgent::name)->start_s;
  }

  test::TempFolder folder_;
  const std::filesystem::path result_ = folder_ / "result";
  unsigned films_ = 0;
  Sequence sequence_;
};

TEST_F(StartsTest, FilmsThatHeardTheSamePlayAsTheyWereTaken) {
  sequence_.agents = {film("a", 2), film("b", 3.5), film("c", 1.25)};
  const Starts starts(&sequence_);
  EXPECT_NEAR(start_s("b") - start_s("a"), -1.5, 0.01);
  EXPECT_NEAR(start_s("c") - start_s("a"), 0.75, 0.01);
  EXPECT_EQ(start_s("c"), 0) << "the first plays from its beginning";
}

TEST_F(StartsTest, AStartThatIsGivenStays) {
  sequence_.agents = {film("a", 2), film("b", 3.5)};
  sequence_.agents[1].start_is_open = false;
  const Starts starts(&sequence_);
  EXPECT_EQ(start_s("a"), 0);
  EXPECT_EQ(start_s("b"), 0);
}

TEST_F(StartsTest, WithoutSoundWhatARunFoundTellsAndIsWorthAnother) {
  sequence_.agents = {film("a", 2, false), film("b", 3.5, false)};
  Starts starts(&sequence_);
  EXPECT_EQ(start_s("b"), 0);
  EXPECT_FALSE(starts.improve(result_)) << "no run";
  report(1.5);
  EXPECT_TRUE(starts.improve(result_));
  EXPECT_EQ(start_s("a"), 0);
  EXPECT_EQ(start_s("b"), -1.5);
  report(0.02);
  EXPECT_FALSE(starts.improve(result_)) << "too little to run once more";
  EXPECT_EQ(start_s("b"), -1.5) << "as it was played";
}

TEST_F(StartsTest, ALagCountsWhicheverOfTheTwoIsOpen) {
  sequence_.file = folder_ / "sequence.yaml";
  sequence_.agents = {film("a", 2, false), film("b", 3.5, false)};
  sequence_.agents[0].start_is_open = true;
  sequence_.agents[1].start_is_open = false;
  Starts starts(&sequence_);
  report(1.5);
  EXPECT_TRUE(starts.improve(result_));
  EXPECT_EQ(start_s("a"), 1.5);
  EXPECT_EQ(start_s("b"), 0) << "it is given";
}

TEST_F(StartsTest, WhoHeardEachOtherStayTogetherWhereTheReferenceIsMute) {
  sequence_.agents = {film("a", 2, false), film("b", 3.5), film("c", 5)};
  Starts starts(&sequence_);
  EXPECT_NEAR(start_s("c") - start_s("b"), -1.5, 0.01);
  report(1.5);
  EXPECT_TRUE(starts.improve(result_));
  EXPECT_NEAR(start_s("b") - start_s("a"), -1.5, 0.01);
  EXPECT_NEAR(start_s("c") - start_s("a"), -3, 0.01);
}

TEST_F(StartsTest, WhatMovesOverrulesASoundThatRepeatsItself) {
  sequence_.agents = {film("a", 2), film("b", 3.5)};
  Starts starts(&sequence_);
  report(2);
  EXPECT_TRUE(starts.improve(result_));
  EXPECT_NEAR(start_s("b"), -3.5, 0.01);
}

TEST_F(StartsTest, HowMuchIsPlayedCountsFromTheBeginningOfTheSource) {
  sequence_.agents = {film("a", 2), film("b", 3.5)};
  sequence_.agents[1].duration_s = 1;
  const Starts starts(&sequence_);
  EXPECT_NEAR(*sequence_.agents[1].duration_s, 2.5, 0.01) << "the first 1.5 s of the run are before it";
}

TEST_F(StartsTest, AreWrittenForTheNextTime) {
  sequence_.name = "films";
  sequence_.agents = {film("a", 2), film("b", 3.5), film("c", 0, false)};
  sequence_.agents.push_back({.name = "d", .source = "rtsp://10.0.0.4/stream"});
  const Starts starts(&sequence_);
  report(0);
  starts.write(result_);
  const nlohmann::json report = read_json(ResultFolder(result_).report());
  EXPECT_EQ(report["agents"]["a"]["start_by"], "reference");
  EXPECT_EQ(report["agents"]["b"]["start_by"], "sound");
  EXPECT_EQ(report["agents"]["c"]["start_by"], "nothing");
  const Sequence again = load_sequence(ResultFolder(result_).sequence());
  ASSERT_EQ(again.agents.size(), 4U);
  EXPECT_EQ(again.agents[3].source, "rtsp://10.0.0.4/stream");
  EXPECT_EQ(again.agents[1].source, sequence_.agents[1].source);
  EXPECT_EQ(again.agents[1].start_s, start_s("b"));
  EXPECT_TRUE(again.agents[2].start_is_open);
}

}  // namespace
}  // namespace coslam::starts_test
