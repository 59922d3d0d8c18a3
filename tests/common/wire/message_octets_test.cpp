// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/message_octets.h"

#include <gtest/gtest.h>

#include "common/wire/codec.h"
#include "tests/support/wire_equal.h"
#include "tests/support/wire_values.h"

namespace coslam::message_octets_test {
namespace {

TEST(MessageOctets, AreThoseOfOneMessage) {
  const Hello hello = test::WireValues(1).hello("cam0", RunId(9));
  std::vector<std::uint8_t> octets = octets_of(encode(hello));
  EXPECT_EQ(octets.front(), kProtocolVersion) << "little endian, nothing before it";
  idl::Hello message;
  ASSERT_TRUE(read_octets(octets, message));
  test::expect_same(*decode(message), hello);
  for (std::size_t size = 0; size < octets.size(); ++size)
    EXPECT_FALSE(read_octets(std::span(octets).first(size), message)) << size;
  octets.push_back(0);
  EXPECT_FALSE(read_octets(octets, message)) << "something after it";
}

}  // namespace
}  // namespace coslam::message_octets_test
