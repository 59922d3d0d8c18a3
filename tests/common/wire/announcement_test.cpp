// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/announcement.h"

#include <gmock/gmock.h>

#include <random>

#include "tests/common/wire/announcement_octets.h"

namespace coslam::announcement_test {
namespace {

using test::announcement;
using Octets = std::vector<std::uint8_t>;
using ::testing::ElementsAre;

TEST(Announcement, NameAndWhereItIs) {
  const auto read = read_announcement(announcement());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->name, "left");
  EXPECT_EQ(read->key, (ParticipantKey{1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
  EXPECT_THAT(read->vendor, ElementsAre(1, 15));
  EXPECT_THAT(read->endpoints, ElementsAre(Ipv4Endpoint{0x0a580001, 9160}));
}

TEST(Announcement, OfNothingElse) {
  EXPECT_FALSE(read_announcement({}));
  Octets other = announcement();
  other[other.size() - 1] = 0;
  const std::size_t writer = 20 + 12 + 4 + 8;
  other[writer + 3] = 0xc7;
  EXPECT_FALSE(read_announcement(other));
  EXPECT_TRUE(is_rtps(other));
  other[0] = 'X';
  EXPECT_FALSE(is_rtps(other));
}

TEST(Announcement, NonsenseHurtsNobody) {
  std::mt19937 random(7);
  const Octets right = announcement();
  for (std::size_t size = 0; size < right.size(); ++size) (void)read_announcement(std::span(right).first(size));
  for (int i = 0; i < 20000; ++i) {
    Octets octets = right;
    for (unsigned k = 0; k < 1 + random() % 6; ++k) {
      octets[20 + random() % (octets.size() - 20)] = static_cast<std::uint8_t>(random());
    }
    const auto read = read_announcement(octets);
    EXPECT_LE(read ? read->name.size() : 0, 64U);
  }
}

}  // namespace
}  // namespace coslam::announcement_test
