// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/track_bits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include "common/wire/bits.h"

namespace coslam::track_bits_test {
namespace {

using Octets = std::vector<std::uint8_t>;

constexpr std::uint32_t kLastId = std::numeric_limits<std::uint32_t>::max() - 1;

void expect_equal(const CodedTracks& got, const CodedTracks& expected) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(got[i].track, expected[i].track) << i;
    EXPECT_EQ(got[i].at, expected[i].at) << i;
  }
}

Octets expect_read_back(const CodedTracks& tracks, const CodedTracks& reference) {
  const Octets octets = pack_tracks(tracks, reference);
  CodedTracks got;
  const Problem problem = unpack_tracks(octets, tracks.size(), reference, got);
  EXPECT_FALSE(problem) << name_of(*problem);
  expect_equal(got, tracks);
  return octets;
}

Problem problem_of(const Octets& octets, std::size_t count, const CodedTracks& reference) {
  CodedTracks ignored;
  return unpack_tracks(octets, count, reference, ignored);
}

class TrackBits : public testing::Test {
 protected:
  int number(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }

  CodedTracks tracks_of(std::size_t count, std::uint32_t most_id, std::int32_t most_units) {
    std::set<std::uint32_t> ids;
    while (ids.size() < count) ids.insert(std::uniform_int_distribution<std::uint32_t>(1, most_id)(random_));
    CodedTracks out;
    for (const std::uint32_t id : ids)
      out.push_back({id, {number(-most_units, most_units), number(-most_units, most_units)}});
    return out;
  }

  // Some have ended, some have moved a little, some are new, among the others and after them.
  CodedTracks next_of(const CodedTracks& before, std::uint32_t first_new) {
    CodedTracks out;
    for (CodedTrack t : before) {
      if (number(0, 9) == 0) continue;
      t.at.x = std::clamp(t.at.x + 300 + number(-20, 20), -kMostUnits, kMostUnits);
      t.at.y = std::clamp(t.at.y - 100 + number(-20, 20), -kMostUnits, kMostUnits);
      out.push_back(t);
    }
    for (std::uint32_t i = 0; i < 20; ++i) out.push_back({first_new + 3 * i, {number(-90, 90), number(-90, 90)}});
    std::ranges::sort(out, {}, &CodedTrack::track);
    return out;
  }

  std::mt19937 random_{11};
};

TEST_F(TrackBits, TracksAloneAreReadBack) {
  EXPECT_TRUE(expect_read_back({}, {}).empty());
  expect_read_back({{1, {0, 0}}}, {});
  expect_read_back({{kLastId, {kMostUnits, -kMostUnits}}}, {});
  expect_read_back({{1, {-kMostUnits, -kMostUnits}}, {kLastId, {kMostUnits, kMostUnits}}}, {});
  expect_read_back(tracks_of(300, 100'000, 20'000), {});
  expect_read_back(tracks_of(idl::MAX_TRACKS, kLastId, kMostUnits), {});
}

TEST_F(TrackBits, TracksAgainstAReferenceAreReadBack) {
  const CodedTracks before = tracks_of(200, 5'000, 20'000);
  const CodedTracks after = next_of(before, before.back().track + 1);
  const std::size_t alone = expect_read_back(after, {}).size();
  EXPECT_LT(expect_read_back(after, before).size(), 3 * alone / 4) << "what both ends know is not said again";
  expect_read_back(before, before);
  expect_read_back({}, before);
  expect_read_back({before.begin() + 199, before.end()}, before);
  expect_read_back(tracks_of(200, 5'000, kMostUnits), before);
}

TEST_F(TrackBits, NewTracksMayHaveSmallerIdsThanTheReference) {
  const CodedTracks reference{{10, {0, 0}}, {20, {50, 50}}};
  expect_read_back({{3, {1, 2}}, {10, {0, 1}}, {15, {7, 7}}, {20, {51, 50}}, {21, {9, 9}}}, reference);
  expect_read_back({{3, {1, 2}}}, reference);
}

TEST_F(TrackBits, TracksMayCrossTheWholeRange) {
  CodedTracks before, after;
  for (std::uint32_t i = 1; i <= 20; ++i) {
    const std::int32_t side = i % 2 == 0 ? kMostUnits : -kMostUnits;
    before.push_back({i, {side, -side}});
    after.push_back({i, {-side, side}});
  }
  expect_read_back(after, before);
}

TEST_F(TrackBits, NoOctetIsLeftOutAndNoneIsAdded) {
  const CodedTracks before = tracks_of(30, 400, 900), after = next_of(before, 500);
  for (const CodedTracks& reference : {CodedTracks(), before}) {
    Octets octets = pack_tracks(after, reference);
    octets.push_back(0);
    EXPECT_TRUE(problem_of(octets, after.size(), reference)) << "one octet too many";
    octets.pop_back();
    while (!octets.empty()) {
      octets.pop_back();
      EXPECT_TRUE(problem_of(octets, after.size(), reference)) << "cut off after " << octets.size();
    }
  }
}

TEST_F(TrackBits, AnotherCountThanThatOfTheWriterIsRefused) {
  const CodedTracks before = tracks_of(30, 400, 900);
  const Octets octets = pack_tracks(before, before);
  EXPECT_EQ(problem_of(octets, 29, before), Rejection::kSizeMismatch);
  EXPECT_TRUE(problem_of(octets, 31, before));
  EXPECT_TRUE(problem_of(octets, 30, {before.begin(), before.end() - 1})) << "another reference";
}

TEST_F(TrackBits, MoreMissingTracksThanTheReferenceHasAreRefused) {
  const CodedTracks reference{{1, {0, 0}}, {2, {5, 5}}};
  BitWriter many;
  many.put(3, 12);
  EXPECT_EQ(problem_of(many.take(), 0, reference), Rejection::kTooMany);
  BitWriter beyond;
  beyond.put(1, 12);
  const std::uint32_t step = 2;  // a third track
  beyond.put_list({&step, 1}, 12);
  EXPECT_EQ(problem_of(beyond.take(), 1, reference), Rejection::kMalformed);
}

TEST_F(TrackBits, IdsThatOverflowOrRepeatAreRefused) {
  BitWriter overflow;
  overflow.put(0, 1);
  const std::uint32_t steps[] = {kLastId, 1};
  overflow.put_list(steps, 32);
  EXPECT_EQ(problem_of(overflow.take(), 2, {}), Rejection::kIdsNotAscending);

  const CodedTracks reference{{7, {0, 0}}};
  BitWriter twice;  // 7 is carried on and is new too
  twice.put(0, 12);
  twice.put(0, 1);
  const std::uint32_t to_seven = 6, nothing = 0;
  twice.put_list({&to_seven, 1}, 32);
  for (int i = 0; i < 8; ++i) twice.put(0, 16);
  twice.put_list({&nothing, 1}, 17);
  twice.put_list({&nothing, 1}, 17);
  for (int i = 0; i < 4; ++i) twice.put(0, 16);
  EXPECT_EQ(problem_of(twice.take(), 2, reference), Rejection::kIdsNotAscending);
}

TEST_F(TrackBits, PlacesBeyondTheRangeAreRefused) {
  BitWriter fresh;
  fresh.put(0, 1);
  const std::uint32_t first = 0;
  fresh.put_list({&first, 1}, 32);
  fresh.put(static_cast<std::uint16_t>(kMostUnits), 16);
  fresh.put(0, 16);
  fresh.put(1, 16);  // a box of two places, and the second of them
  fresh.put(0, 16);
  fresh.put_below(1, 2);
  fresh.put_below(0, 1);
  EXPECT_EQ(problem_of(fresh.take(), 1, {}), Rejection::kOutOfRange);

  const CodedTracks reference{{7, {kMostUnits, 0}}};
  for (const std::uint32_t residual : {2U, 2U * (1U << 15U)}) {
    BitWriter carried;
    carried.put(0, 12);
    for (int i = 0; i < 8; ++i) carried.put(0, 16);
    const std::uint32_t none = 0;
    carried.put_list({&residual, 1}, 17);
    carried.put_list({&none, 1}, 17);
    EXPECT_EQ(problem_of(carried.take(), 1, reference), Rejection::kOutOfRange) << residual;
  }
}

TEST_F(TrackBits, AChangedBitNeverGivesTracksThatNobodyCouldHave) {
  const CodedTracks before = tracks_of(40, 400, kMostUnits), after = next_of(before, 500);
  const Octets octets = pack_tracks(after, before);
  for (std::size_t bit = 0; bit < 8 * octets.size(); ++bit) {
    Octets changed = octets;
    changed[bit / 8] = static_cast<std::uint8_t>(changed[bit / 8] ^ 1U << bit % 8);
    CodedTracks got;
    if (unpack_tracks(changed, after.size(), before, got)) continue;
    ASSERT_EQ(got.size(), after.size()) << bit;
    for (std::size_t i = 0; i < got.size(); ++i) {
      ASSERT_LE(std::abs(got[i].at.x), kMostUnits) << bit;
      ASSERT_LE(std::abs(got[i].at.y), kMostUnits) << bit;
      ASSERT_TRUE(i == 0 || got[i - 1].track < got[i].track) << bit;
    }
  }
}

}  // namespace
}  // namespace coslam::track_bits_test
