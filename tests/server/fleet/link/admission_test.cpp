// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/admission.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace coslam::admission_test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Hello hello(const std::string& agent, std::uint64_t run) {
  Hello h;
  h.agent = agent;
  h.agent_run = RunId(run);
  return h;
}

class AdmissionTest : public testing::Test {
 protected:
  std::vector<std::uint64_t> admitted() {
    std::vector<std::uint64_t> runs;
    for (const Hello& h : admission_.take_admitted()) runs.push_back(h.agent_run.value);
    return runs;
  }
  std::string refusal_of(std::uint64_t run) const {
    for (const Refusal& r : admission_.refused()) {
      if (r.agent_run == RunId(run)) return r.reason;
    }
    return "";
  }

  Instant now_{};
  Admission admission_{1000ms};
};

TEST_F(AdmissionTest, EveryNameGetsASeat) {
  admission_.hello(hello("a", 1), now_);
  admission_.hello(hello("b", 2), now_);
  EXPECT_THAT(admitted(), ElementsAre(1, 2));
  admission_.hello(hello("a", 1), now_);
  EXPECT_THAT(admitted(), IsEmpty()) << "the same hello again";
  EXPECT_EQ(admission_.find(RunId(2))->agent, "b");
}

TEST_F(AdmissionTest, SamplesNeedAnAdmittedRun) {
  EXPECT_EQ(admission_.check("a", RunId(1)), Rejection::kUnknownAgent);
  admission_.hello(hello("a", 1), now_);
  admission_.hello(hello("b", 2), now_);
  EXPECT_EQ(admission_.check("a", RunId(1)), std::nullopt);
  EXPECT_EQ(admission_.check("a", RunId(5)), Rejection::kUnknownAgent) << "its hello may still come";
  EXPECT_EQ(admission_.check("b", RunId(1)), Rejection::kWrongRun) << "the run of another name";
}

TEST_F(AdmissionTest, ASecondRunOfALivingAgentIsRefused) {
  admission_.hello(hello("a", 1), now_);
  admission_.hello(hello("a", 2), now_);
  admission_.tick(now_ + 999ms);
  EXPECT_EQ(refusal_of(2), "") << "the first may be dead already";
  admission_.tick(now_ + 1000ms);
  EXPECT_THAT(refusal_of(2), HasSubstr("the name 'a' is taken by a running agent"));
  EXPECT_THAT(admitted(), ElementsAre(1));
  EXPECT_EQ(admission_.check("a", RunId(2)), Rejection::kWrongRun);
  EXPECT_EQ(admission_.check("a", RunId(1)), std::nullopt);
}

TEST_F(AdmissionTest, ARestartWaitsUntilTheOldRunIsSilent) {
  admission_.hello(hello("a", 1), now_);
  admission_.hello(hello("a", 2), now_);
  EXPECT_THAT(admitted(), ElementsAre(1));
  admission_.silent(RunId(1));
  EXPECT_THAT(admitted(), ElementsAre(2));
  admission_.tick(now_ + 1h);
  EXPECT_EQ(refusal_of(2), "");
  EXPECT_EQ(admission_.check("a", RunId(2)), std::nullopt);
}

TEST_F(AdmissionTest, ARestartAfterSilenceIsAdmittedAtOnce) {
  admission_.hello(hello("a", 1), now_);
  admission_.silent(RunId(1));
  admission_.hello(hello("a", 2), now_);
  EXPECT_THAT(admitted(), ElementsAre(1, 2));
}

TEST_F(AdmissionTest, AReplacedRunThatComesBackIsToldSo) {
  admission_.hello(hello("a", 1), now_);
  admission_.silent(RunId(1));
  admission_.hello(hello("a", 2), now_);
  EXPECT_THAT(refusal_of(1), HasSubstr("another agent named 'a' took over while this one was silent"));
  EXPECT_EQ(admission_.check("a", RunId(1)), Rejection::kWrongRun);
}

TEST_F(AdmissionTest, SilenceAloneCostsNoSeat) {
  admission_.hello(hello("a", 1), now_);
  admission_.silent(RunId(1));
  EXPECT_EQ(admission_.check("a", RunId(1)), std::nullopt) << "a sample is a sign of life";
  admission_.hello(hello("a", 2), now_);
  admission_.tick(now_ + 1s);
  EXPECT_NE(refusal_of(2), "");
}

TEST_F(AdmissionTest, ARunThatWasGoneIsAdmittedAgain) {
  admission_.hello(hello("a", 1), now_);
  EXPECT_THAT(admitted(), ElementsAre(1));
  admission_.note_gone(RunId(1));
  EXPECT_FALSE(admission_.present(RunId(1)));
  EXPECT_EQ(admission_.check("a", RunId(1)), std::nullopt);
  EXPECT_THAT(admitted(), ElementsAre(1));
  EXPECT_TRUE(admission_.present(RunId(1)));
}

TEST_F(AdmissionTest, AnotherProtocolIsRefusedWithBothVersions) {
  Hello old = hello("a", 1);
  old.protocol = 99;
  admission_.hello(old, now_);
  EXPECT_THAT(refusal_of(1),
              HasSubstr("agent 'a' speaks protocol 99 and the server protocol " + std::to_string(kProtocolVersion)));
  EXPECT_THAT(admitted(), IsEmpty());
}

TEST_F(AdmissionTest, TheServerMayTurnAnAgentAway) {
  admission_.hello(hello("a", 1), now_);
  admission_.refuse("a", RunId(1), "not in\nthe sequence");
  EXPECT_EQ(refusal_of(1), "not in the sequence") << "one line";
  EXPECT_EQ(admission_.check("a", RunId(1)), Rejection::kWrongRun);
  admission_.hello(hello("a", 2), now_);
  EXPECT_THAT(admitted(), ElementsAre(1, 2)) << "the name is free again";
}

TEST_F(AdmissionTest, RoomIsBoundedAndThatOfGoneAgentsIsReused) {
  for (std::uint64_t i = 0; i < 64; ++i) admission_.hello(hello("a" + std::to_string(i), 100 + i), now_);
  EXPECT_EQ(admitted().size(), 64u);
  admission_.hello(hello("more", 1), now_);
  EXPECT_THAT(refusal_of(1), HasSubstr("no room"));
  admission_.note_gone(RunId(110));
  admission_.hello(hello("more", 2), now_);
  EXPECT_THAT(admitted(), ElementsAre(2));
}

}  // namespace
}  // namespace coslam::admission_test
