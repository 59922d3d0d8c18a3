// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.h"
#include "tests/common/mcap/mcap_file.h"
#include "tests/common/recording/bag_file.h"
#include "tests/support/temp_folder.h"

namespace coslam::mcap::reader_test {
namespace {

using coslam::test::TempFolder;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::vector<std::string> rest_of(Reader& reader) {
  std::vector<std::string> texts;
  while (const auto message = reader.next()) texts.push_back(message->octets);
  return texts;
}

std::vector<std::string> numbers(int from, int to, int step = 1) {
  std::vector<std::string> texts;
  for (int i = from; i < to; i += step) texts.push_back(std::to_string(i));
  return texts;
}

class ReaderOf : public ::testing::TestWithParam<Compression> {
 protected:
  std::string file(int messages, bool close = true) {
    return test::counted_messages(messages, {.compression = GetParam(), .chunk_bytes = 1000}, close);
  }
  TempFolder folder_;
};

TEST_P(ReaderOf, ReadsWhatWasWritten) {
  Reader reader(folder_.write("a.mcap", file(200)));
  EXPECT_TRUE(reader.has_summary());
  EXPECT_EQ(reader.warning(), "");
  ASSERT_NE(reader.find("/odd"), nullptr);
  EXPECT_EQ(reader.find("/nowhere"), nullptr);
  EXPECT_EQ(reader.schema_of(*reader.find("/odd")).text, "string data\n");
  EXPECT_EQ(reader.schema_of(*reader.find("/none")).name, "");
  EXPECT_EQ(rest_of(reader), numbers(0, 200));
}

TEST_P(ReaderOf, GoesToATimeAndATopic) {
  Reader reader(folder_.write("a.mcap", file(200)));
  reader.seek({reader.find("/odd")->id}, 150'000'000);
  const auto message = reader.next();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->octets, "151");
  EXPECT_EQ(message->noted_ns, 151'000'000);
  EXPECT_EQ(message->sequence, 75U);
  EXPECT_EQ(rest_of(reader), numbers(153, 200, 2));
  reader.seek({reader.find("/none")->id});
  EXPECT_FALSE(reader.next());
  reader.seek();
  EXPECT_EQ(rest_of(reader).size(), 200U) << "once more from the start";
}

TEST_P(ReaderOf, AFileThatWasNotClosedIsReadAllTheSame) {
  Reader reader(folder_.write("a.mcap", file(200, false)));
  EXPECT_FALSE(reader.has_summary());
  EXPECT_THAT(reader.warning(), HasSubstr("cut off"));
  reader.seek({reader.find("/even")->id}, 100'000'000);
  EXPECT_EQ(rest_of(reader), numbers(100, 200, 2));
}

TEST_P(ReaderOf, AFileCutOffAnywhereNeverDoesWorseThanASentence) {
  const std::string whole = file(60);
  std::size_t least = 60;
  for (std::size_t size = whole.size() - 1; size > 0; size -= 31) {
    const auto path = folder_.write("a.mcap", whole.substr(0, size));
    try {
      Reader reader(path);
      EXPECT_FALSE(reader.has_summary());
      const auto texts = rest_of(reader);
      EXPECT_EQ(texts, numbers(0, static_cast<int>(texts.size())));
      EXPECT_LE(texts.size(), least);
      least = texts.size();
    } catch (const UserError& e) {
      EXPECT_LT(size, kMagic.size()) << e.what();
    }
    if (size < 31) break;
  }
  EXPECT_EQ(least, 0U);
}

TEST_P(ReaderOf, AnOctetThatChangedIsSeen) {
  const std::string whole = file(60);
  for (std::size_t at = 0; at < whole.size(); at += 11) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x41);
    const auto path = folder_.write("a.mcap", changed);
    try {
      Reader reader(path);
      rest_of(reader);  // what is in a header or an index may change unseen; nothing may break
    } catch (const UserError& e) {
      EXPECT_THAT(e.what(), HasSubstr(path.string()));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Mcap, ReaderOf, ::testing::Values(Compression::kNone, Compression::kZstd));

TEST(Reader, ADamagedChunkIsNamed) {
  const TempFolder folder;
  std::string octets = test::counted_messages(60, {.compression = Compression::kNone, .chunk_bytes = 1000});
  const std::size_t place = octets.find("37", octets.find("36"));
  octets[place] = 'x';
  Reader reader(folder.write("a.mcap", octets));
  EXPECT_THAT([&] { rest_of(reader); }, ThrowsMessage<UserError>(HasSubstr("is damaged: the chunk at octet")));
}

TEST(Reader, ADamagedSummaryIsDoneWithout) {
  const TempFolder folder;
  std::string octets = test::counted_messages(60, {});
  octets[octets.size() - 100] ^= 1;
  Reader reader(folder.write("a.mcap", octets));
  EXPECT_THAT(reader.warning(), HasSubstr("summary is damaged"));
  EXPECT_EQ(rest_of(reader), numbers(0, 60));
}

TEST(Reader, MessagesOutOfOrderComeByTime) {
  const TempFolder folder;
  std::string octets;
  Writer writer([&](std::string_view more) { octets += more; }, {.chunk_bytes = 60});
  const auto channel = writer.add_channel("/a", "json", 0);
  for (const int t : {5, 1, 4, 2, 6, 3, 0}) writer.write(channel, t, std::string_view(std::to_string(t)));
  writer.close();
  Reader reader(folder.write("a.mcap", octets));
  EXPECT_EQ(rest_of(reader), numbers(0, 7));
}

TEST(Reader, MessagesMayStandOutsideOfChunks) {
  const TempFolder folder;
  OctetWriter header, end;
  header.put_text("");
  header.put_text("");
  std::string octets(kMagic);
  octets += record(Opcode::kHeader, header.octets()) + record_of(Channel{1, 0, "/a", "json", {}});
  for (const int t : {1, 0}) {
    OctetWriter message;
    message.put(std::uint16_t{1});
    message.put(std::uint32_t{0});
    message.put(static_cast<std::uint64_t>(t));
    message.put(static_cast<std::uint64_t>(t));
    message.put_octets(std::to_string(t));
    octets += record(Opcode::kMessage, message.octets());
  }
  end.put(std::uint32_t{0});
  octets += record(Opcode::kDataEnd, end.octets()) + record(Opcode::kFooter, std::string(20, '\0'));
  octets += kMagic;
  Reader reader(folder.write("a.mcap", octets));
  EXPECT_EQ(reader.warning(), "");
  EXPECT_EQ(rest_of(reader), numbers(0, 2));
}

TEST(Reader, ChunksMayBeOfLz4) {
  const TempFolder folder;
  std::string records = record_of(Channel{1, 0, "/a", "json", {}});
  for (int i = 0; i < 100; ++i) {
    OctetWriter message;
    message.put(std::uint16_t{1});
    message.put(static_cast<std::uint32_t>(i));
    message.put(static_cast<std::uint64_t>(i));
    message.put(static_cast<std::uint64_t>(i));
    message.put_octets(std::to_string(i));
    records += record(Opcode::kMessage, message.octets());
  }
  const auto file = [&](const std::string& packed) {
    OctetWriter header, chunk;
    header.put_text("");
    header.put_text("");
    chunk.put(std::uint64_t{0});
    chunk.put(std::uint64_t{99});
    chunk.put(static_cast<std::uint64_t>(records.size()));
    chunk.put(crc32_of(records));
    chunk.put_text("lz4");
    chunk.put(static_cast<std::uint64_t>(packed.size()));
    chunk.put_octets(packed);
    return folder.write("a.mcap", std::string(kMagic) + record(Opcode::kHeader, header.octets()) +
                                      record(Opcode::kChunk, chunk.octets()));
  };
  const std::string packed = recording::test::lz4_frame(records);
  Reader reader(file(packed));
  EXPECT_EQ(rest_of(reader), numbers(0, 100));
  EXPECT_THAT([&] { Reader(file(packed.substr(0, packed.size() / 2))); },
              ThrowsMessage<UserError>(HasSubstr("is not what was written")));
}

TEST(Reader, IsCalledWhatItIsNamed) {
  const TempFolder folder;
  EXPECT_THAT([&] { Reader(folder.write("a.mcap", ""), "walk.mcap.zstd"); },
              ThrowsMessage<UserError>(HasSubstr("walk.mcap.zstd: is no MCAP file")));
}

TEST(Reader, SaysWhatAFileIsNot) {
  const TempFolder folder;
  EXPECT_THAT([&] { Reader(folder / "none.mcap"); }, ThrowsMessage<UserError>(HasSubstr("cannot be read")));
  EXPECT_THAT([&] { Reader(folder.write("a.mcap", "")); }, ThrowsMessage<UserError>(HasSubstr("is no MCAP file")));
  EXPECT_THAT([&] { Reader(folder.write("a.mcap", "#ROSBAG V2.0\n")); },
              ThrowsMessage<UserError>(HasSubstr("is no MCAP file")));
  EXPECT_THAT([&] { Reader(folder.write("a.mcap", "\x89MCAP1\r\n")); },
              ThrowsMessage<UserError>(HasSubstr("another version")));
}

TEST(Reader, SaysWhichCompressionIsNotKnown) {
  const TempFolder folder;
  std::string octets = test::counted_messages(3, {});
  for (std::size_t at = octets.find("zstd"); at != std::string::npos; at = octets.find("zstd")) {
    octets.replace(at, 4, "lz44");
  }
  // Its summary no longer has the right check sum, so it is gone through at once.
  EXPECT_THAT([&] { Reader(folder.write("a.mcap", octets)); },
              ThrowsMessage<UserError>(HasSubstr("compressed with lz44")));
}

}  // namespace
}  // namespace coslam::mcap::reader_test
