// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/fields.h"

#include <gmock/gmock.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"

namespace coslam::fields_test {
namespace {

using ::testing::ElementsAre;

struct Inner {
  int number = 0;
};
auto fields(Like<Inner> auto& i) { return std::tuple(kept("number", i.number)); }

struct Outer {
  std::string name;
  std::optional<Inner> inner;
  std::array<double, 3> values{};
  TimeNs seen_ns = 0;
  std::vector<Inner> of_now;
};
auto fields(Like<Outer> auto& o) {
  return std::tuple(kept("name", o.name), kept("inner", o.inner, 4), kept("values", o.values),
                    instant("seen_ns", o.seen_ns), not_kept("of_now", o.of_now));
}

TEST(Fields, AreVisitedInTheirOrder) {
  const Outer outer;
  std::vector<std::string> all, of_file, instants;
  each_field(outer, [&](const auto& field) {
    all.emplace_back(field.name);
    if (std::remove_cvref_t<decltype(field)>::kIsInstant) instants.emplace_back(field.name);
  });
  each_kept_field(outer, [&](const auto& field) { of_file.push_back(field.name + std::to_string(field.since)); });
  EXPECT_THAT(all, ElementsAre("name", "inner", "values", "seen_ns", "of_now"));
  EXPECT_THAT(of_file, ElementsAre("name0", "inner4", "values0", "seen_ns0"));
  EXPECT_THAT(instants, ElementsAre("seen_ns"));
}

TEST(Fields, AreThoseOfTheValueItself) {
  Inner inner;
  each_field(inner, [](const auto& field) { field.value = 7; });
  EXPECT_EQ(inner.number, 7);
}

TEST(Fields, MembersAreCounted) {
  EXPECT_EQ(detail::member_count<Inner>(), 1U);
  EXPECT_EQ(detail::member_count<Outer>(), 5U) << "an array is one, and so is what may be absent";
  EXPECT_TRUE(HasFields<Outer> && HasFields<const Outer> && !HasFields<std::string>);
}

}  // namespace
}  // namespace coslam::fields_test
