// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/journal.h"
#include "tests/support/map_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>

namespace coslam::journal_test {
namespace {

// As they stand in files.
bool is_a_name(std::string_view name) {
  return !name.empty() && std::ranges::all_of(name, [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; });
}

TEST(Journal, EveryReasonHasANameOfItsOwnThatIsFoundAgain) {
  std::set<std::string_view> names, clauses;
  for (std::size_t i = 0; i < kWhys; ++i) {
    const Why why = static_cast<Why>(i);
    const WhyText& text = text_of(why);
    EXPECT_TRUE(is_a_name(text.name)) << i;
    EXPECT_TRUE(names.insert(text.name).second) << text.name;
    EXPECT_TRUE(clauses.insert(text.clause).second) << text.clause;
    EXPECT_EQ(why_of(text.name), why);
  }
}

TEST(Journal, EveryKindHasANameOfItsOwnThatIsFoundAgain) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < kEventKinds; ++i) {
    const EventKind kind = static_cast<EventKind>(i);
    EXPECT_TRUE(is_a_name(name_of(kind))) << i;
    EXPECT_TRUE(names.insert(name_of(kind)).second) << name_of(kind);
    EXPECT_EQ(kind_of(name_of(kind)), kind);
  }
}

TEST(Journal, NamesOfPhasesAndMotions) {
  EXPECT_EQ(name_of(PointPhase::kTrial), "trial");
  EXPECT_EQ(name_of(PointPhase::kStatic), "static");
  EXPECT_EQ(name_of(PointPhase::kMoving), "moving");
  EXPECT_EQ(name_of(TrackMotion::kResting), "resting");
  EXPECT_EQ(name_of(TrackMotion::kDoubtful), "doubtful");
  EXPECT_EQ(name_of(TrackMotion::kMoving), "moving");
}

TEST(Journal, UnknownNamesAreNothing) {
  for (const char* name : {"", "outside", "outside_gate ", "Outside_gate", "point_made"})
    EXPECT_FALSE(why_of(name)) << name;
  for (const char* name : {"", "point", "outside_gate"}) EXPECT_FALSE(kind_of(name)) << name;
}

TEST(Journal, ClausesHaveRoomForTwoFiguresAndNoOther) {
  for (std::size_t i = 0; i < kWhys; ++i) {
    const std::string clause(text_of(static_cast<Why>(i)).clause);
    ASSERT_FALSE(clause.empty()) << i;
    EXPECT_TRUE(clause.back() != '.' && clause.back() != ' ') << clause << ": it is part of a sentence";
    std::string rest = clause;
    for (const std::string figure : {"{a}", "{b}"}) {
      const auto at = rest.find(figure);
      if (at != std::string::npos) rest.erase(at, figure.size());
    }
    EXPECT_EQ(rest.find_first_of("{}"), std::string::npos) << clause;
  }
}

TEST(Journal, KeepsWhatHappenedUntilItIsCleared) {
  Journal journal;
  EXPECT_TRUE(journal.enabled());
  journal.note({.set = SetId(3), .kind = EventKind::kMapStarted, .why = Why::kStartedAlone});
  journal.note({.set = SetId(4), .kind = EventKind::kMapMoved, .why = Why::kScaleKnown, .figures = {2, 0}});
  ASSERT_EQ(journal.events().size(), 2U);
  EXPECT_EQ(journal.events()[1].set, SetId(4));
  EXPECT_EQ(journal.events()[1].figures[0], 2);
  test::forget(journal);
  EXPECT_TRUE(journal.events().empty());
}

TEST(Journal, SwitchedOffItKeepsNothing) {
  Journal journal;
  journal.enable(false);
  journal.note({.why = Why::kHello});
  EXPECT_FALSE(journal.enabled());
  EXPECT_TRUE(journal.events().empty());
  journal.enable(true);
  journal.note({.why = Why::kHello});
  EXPECT_EQ(journal.events().size(), 1U);
}

}  // namespace
}  // namespace coslam::journal_test
