// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/records.h"

#include <gtest/gtest.h>

namespace coslam::mcap::records_test {
namespace {

TEST(Records, AreAnOctetALengthAndTheContent) {
  const std::string octets = record_of(Channel{2, 1, "/a", "cdr", {{"k", "v"}}});
  OctetReader in(octets);
  EXPECT_EQ(in.get<Opcode>(), Opcode::kChannel);
  EXPECT_EQ(in.get<std::uint64_t>(), octets.size() - kRecordHead);
  const Channel channel = read_channel(in);
  EXPECT_TRUE(in.ok() && in.rest().empty());
  EXPECT_EQ(channel.id, 2);
  EXPECT_EQ(channel.topic, "/a");
  EXPECT_EQ(channel.metadata.at("k"), "v");
  EXPECT_EQ(octets, std::string("\x04"
                                "\x1f\0\0\0\0\0\0\0"
                                "\2\0\1\0"
                                "\2\0\0\0/a"
                                "\3\0\0\0cdr"
                                "\12\0\0\0"
                                "\1\0\0\0k\1\0\0\0v",
                                40));
}

TEST(Records, WhatIsCutOffIsNotOk) {
  const std::string octets = record_of(ChunkIndex{1, 2, 3, 4, {{5, 6}}, 7, "zstd", 8, 9}).substr(kRecordHead);
  for (std::size_t size = 0; size < octets.size(); ++size) {
    OctetReader in(std::string_view(octets).substr(0, size));
    read_chunk_index(in);
    EXPECT_FALSE(in.ok()) << size;
  }
  OctetReader in(octets);
  EXPECT_EQ(read_chunk_index(in).index_offsets.at(5), 6U);
}

}  // namespace
}  // namespace coslam::mcap::records_test
