// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/announcement.h"

#include <gmock/gmock.h>

#include <random>

namespace coslam {
namespace {

using Octets = std::vector<std::uint8_t>;
using ::testing::ElementsAre;

void append(Octets& to, const Octets& more) { to.insert(to.end(), more.begin(), more.end()); }

// As Fast DDS sends it: a destination, a time stamp, then the data with inline QoS.
Octets announcement() {
  Octets data{0, 0, 16, 0, 0, 1, 0, 0xc7, 0, 1, 0, 0xc2, 0, 0, 0, 0, 1, 0, 0, 0};
  append(data, {0x70, 0, 4, 0, 9, 9, 9, 9, 1, 0, 0, 0});                         // inline QoS
  append(data, {0, 3, 0, 0});                                                    // parameters, little-endian
  append(data, {0x62, 0, 12, 0, 5, 0, 0, 0, 'l', 'e', 'f', 't', 0, 0, 0, 0});    // name
  append(data, {0x32, 0, 24, 0, 1, 0, 0, 0, 0xc8, 0x23, 0, 0});                  // UDP v4, port 9160
  append(data, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 10, 88, 0, 1, 1, 0, 0, 0});  // its address; the end
  Octets out{'R', 'T', 'P', 'S', 2, 3, 1, 15, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  append(out, {0x09, 1, 8, 0, 1, 1, 1, 1, 2, 2, 2, 2});
  append(out, {0x15, 7, static_cast<std::uint8_t>(data.size()), 0});
  append(out, data);
  return out;
}

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
}  // namespace coslam
