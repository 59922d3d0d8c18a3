// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/writer.h"

#include <gtest/gtest.h>

#include "tests/common/mcap/mcap_file.h"

namespace coslam::mcap::writer_test {
namespace {

struct Found {
  Opcode opcode;
  std::string_view content;
  std::size_t offset;
};

// All records of a file, in order.
std::vector<Found> records_of(std::string_view file) {
  std::vector<Found> records;
  for (std::size_t at = kMagic.size(); at + kMagic.size() < file.size();) {
    OctetReader in(file.substr(at));
    const auto opcode = in.get<Opcode>();
    const std::string_view content = in.get_octets(in.get<std::uint64_t>());
    EXPECT_TRUE(in.ok()) << at;
    records.push_back({opcode, content, at});
    at += kRecordHead + content.size();
  }
  return records;
}

TEST(Writer, AFileIsChunksWithIndexesAndASummary) {
  const std::string file = test::counted_messages(100, {.compression = Compression::kNone, .chunk_bytes = 1000});
  EXPECT_TRUE(file.starts_with(kMagic) && file.ends_with(kMagic));
  std::map<Opcode, int> counts;
  for (const Found& record : records_of(file)) ++counts[record.opcode];
  EXPECT_EQ(counts[Opcode::kHeader], 1);
  EXPECT_GT(counts[Opcode::kChunk], 3);
  EXPECT_EQ(counts[Opcode::kMessageIndex], 2 * counts[Opcode::kChunk]);
  EXPECT_EQ(counts[Opcode::kChunkIndex], counts[Opcode::kChunk]);
  EXPECT_EQ(counts[Opcode::kSchema], 1);
  EXPECT_EQ(counts[Opcode::kChannel], 3);
  EXPECT_EQ(counts[Opcode::kStatistics], 1);
  EXPECT_EQ(counts[Opcode::kSummaryOffset], 4);
}

TEST(Writer, IndexesPointAtWhatTheyName) {
  const std::string file = test::counted_messages(100, {.compression = Compression::kNone, .chunk_bytes = 1000});
  std::map<std::size_t, Found> at;
  for (const Found& record : records_of(file)) at.emplace(record.offset, record);
  std::uint64_t summary = 0;
  for (const auto& [offset, found] : at) {
    OctetReader in(found.content);
    if (found.opcode == Opcode::kFooter) summary = read_footer(in).summary;
    if (found.opcode != Opcode::kChunkIndex) continue;
    const ChunkIndex index = read_chunk_index(in);
    const Found& chunk = at.at(index.offset);
    EXPECT_EQ(chunk.opcode, Opcode::kChunk);
    EXPECT_EQ(index.length, kRecordHead + chunk.content.size());
    for (const auto& [channel, place] : index.index_offsets) {
      ASSERT_EQ(at.at(place).opcode, Opcode::kMessageIndex);
      OctetReader list(at.at(place).content);
      EXPECT_EQ(list.get<std::uint16_t>(), channel);
      OctetReader entries(list.get_text());
      const auto t_ns = entries.get<std::uint64_t>();
      const auto place_in_chunk = entries.get<std::uint64_t>();
      const std::string_view records = chunk.content.substr(8 + 8 + 8 + 4 + 4 + 8);
      OctetReader message(records.substr(place_in_chunk));
      EXPECT_EQ(message.get<Opcode>(), Opcode::kMessage);
      message.get<std::uint64_t>();
      EXPECT_EQ(message.get<std::uint16_t>(), channel);
      message.get<std::uint32_t>();
      EXPECT_EQ(message.get<std::uint64_t>(), t_ns);
    }
  }
  EXPECT_EQ(at.at(summary).opcode, Opcode::kSchema);
  EXPECT_EQ(at.rbegin()->second.opcode, Opcode::kFooter);
}

TEST(Writer, CheckSumsCoverTheDataAndTheSummary) {
  const std::string file = test::counted_messages(10, {});
  for (const Found& record : records_of(file)) {
    OctetReader in(record.content);
    if (record.opcode == Opcode::kDataEnd) {
      EXPECT_EQ(in.get<std::uint32_t>(), crc32_of(std::string_view(file).substr(0, record.offset)));
    }
    if (record.opcode == Opcode::kFooter) {
      const Footer footer = read_footer(in);
      const std::size_t end = record.offset + kRecordHead + 16;
      EXPECT_EQ(footer.crc, crc32_of(std::string_view(file).substr(footer.summary, end - footer.summary)));
    }
  }
}

TEST(Writer, TheSameChannelTwiceIsOne) {
  Writer writer([](std::string_view) {});
  const auto schema = writer.add_schema("a", "ros2msg", "int8 x\n");
  EXPECT_EQ(writer.add_schema("a", "ros2msg", "int8 x\n"), schema);
  EXPECT_NE(writer.add_schema("a", "ros2msg", "int8 y\n"), schema);
  const auto channel = writer.add_channel("/a", "cdr", schema);
  EXPECT_EQ(writer.add_channel("/a", "cdr", schema), channel);
  EXPECT_NE(writer.add_channel("/b", "cdr", schema), channel);
}

TEST(Writer, StatisticsCountWhatIsThere) {
  const std::string file = test::counted_messages(7, {});
  for (const Found& record : records_of(file)) {
    if (record.opcode != Opcode::kStatistics) continue;
    OctetReader in(record.content);
    const Statistics s = read_statistics(in);
    EXPECT_EQ(s.messages, 7U);
    EXPECT_EQ(s.channels, 3U);
    EXPECT_EQ(s.chunks, 1U);
    EXPECT_EQ(s.first_ns, 0U);
    EXPECT_EQ(s.last_ns, 6'000'000U);
    EXPECT_EQ(s.of_channels.at(0), 4U);
    EXPECT_FALSE(s.of_channels.contains(2));
  }
}

}  // namespace
}  // namespace coslam::mcap::writer_test
