// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/record/recording_file.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::recording_file_test {
namespace {

using test::error_of;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr std::size_t kBegin_bytes = 12, kRound_record_bytes = 21;

class RecordingFile : public ::testing::Test {
 protected:
  // Three records, of 0, 1 and 5 octets; the whole file.
  std::string written() {
    const std::filesystem::path file = temp_ / "whole.rec";
    {
      RecordWriter writer(file);
      EXPECT_EQ(writer.write({RecordType::kHead, 0, {}}), 0);
      EXPECT_EQ(writer.write({RecordType::kHello, 7, {42}}), 0);
      EXPECT_EQ(writer.write({RecordType::kEnd, 1'000'000'000, {1, 2, 3, 4, 5}}), 0);
    }
    std::ifstream stream(file, std::ios::binary);
    std::filesystem::remove(file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  struct Outcome {
    std::vector<Record> records;
    bool cut_off = false;
    std::string error;
  };
  Outcome read(const std::string& content) {
    Outcome outcome;
    const auto file = temp_.write("a.rec", content);
    outcome.error = error_of<UserError>([&] {
      RecordReader reader(file);
      while (auto record = reader.next()) outcome.records.push_back(std::move(*record));
      outcome.cut_off = reader.cut_off();
    });
    return outcome;
  }

  test::TempFolder temp_;
};

TEST_F(RecordingFile, GivesBackWhatWasWritten) {
  const std::string file = written();
  EXPECT_EQ(file.size(), kBegin_bytes + 3 * kRound_record_bytes + 6);
  const Outcome o = read(file);
  EXPECT_EQ(o.error, "");
  EXPECT_FALSE(o.cut_off);
  ASSERT_THAT(o.records, SizeIs(3));
  EXPECT_EQ(o.records[1].type, RecordType::kHello);
  EXPECT_EQ(o.records[1].t_ns, 7);
  EXPECT_EQ(o.records[1].payload, (std::vector<std::uint8_t>{42}));
  EXPECT_EQ(o.records[2].type, RecordType::kEnd);
  EXPECT_EQ(o.records[2].payload, (std::vector<std::uint8_t>{1, 2, 3, 4, 5}));
}

TEST_F(RecordingFile, CutOffAnywhereItReadsToTheLastWholeRecord) {
  const std::string file = written();
  const std::size_t ends[] = {kBegin_bytes, kBegin_bytes + 21, kBegin_bytes + 21 + 22, file.size()};
  for (std::size_t size = 0; size < file.size(); ++size) {
    const Outcome o = read(file.substr(0, size));
    if (size < kBegin_bytes) {
      EXPECT_THAT(o.error, HasSubstr("is no recording of coslam")) << size;
      continue;
    }
    EXPECT_EQ(o.error, "") << size;
    const auto whole =
        std::count_if(std::begin(ends) + 1, std::end(ends), [&](std::size_t end) { return end <= size; });
    EXPECT_THAT(o.records, SizeIs(whole)) << size;
    EXPECT_EQ(o.cut_off, std::find(std::begin(ends), std::end(ends), size) == std::end(ends)) << size;
  }
}

TEST_F(RecordingFile, EveryFlippedBitIsSeen) {
  const std::string file = written();
  for (std::size_t bit = 0; bit < 8 * file.size(); ++bit) {
    std::string flipped = file;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
    const Outcome o = read(flipped);
    EXPECT_THAT(o.error, HasSubstr(bit < 8 * kBegin_bytes ? "a.rec is " : "is damaged")) << bit;
  }
}

TEST_F(RecordingFile, SaysWhatItIsNot) {
  std::string newer = written();
  newer[8] = 2;
  EXPECT_THAT(read(newer).error, HasSubstr("format 2, and this program reads format 1"));
  EXPECT_THAT(read(std::string(1000, 'x')).error, HasSubstr("is no recording of coslam"));
  EXPECT_THAT(read("").error, HasSubstr("is no recording of coslam"));
  const auto open = [&](const std::filesystem::path& file) {
    return error_of<UserError>([&] { const RecordReader reader(file); });
  };
  EXPECT_THAT(open(temp_ / "nothing"), HasSubstr("nothing: cannot be read"));
  EXPECT_THAT(open(temp_.path()), HasSubstr("cannot be read"));
}

// With all checksums right.
TEST_F(RecordingFile, RecordsThatNobodyWritesAreRefused) {
  const auto refused = [&](const std::vector<Record>& records) {
    const auto file = temp_ / "made.rec";
    std::filesystem::remove(file);
    RecordWriter writer(file);
    for (const Record& record : records) EXPECT_EQ(writer.write(record), 0);
    return error_of<UserError>([&] {
      RecordReader reader(file);
      while (reader.next()) {
      }
    });
  };
  const std::string reason = "is not one that coslam writes";
  EXPECT_EQ(refused({{RecordType::kHead, 5, {}}, {RecordType::kEnd, 5, {}}}), "");
  EXPECT_THAT(refused({{RecordType::kHead, 5, {}}, {RecordType::kEnd, 4, {}}}), HasSubstr("record 2, 0.000000005 s"));
  EXPECT_THAT(refused({{RecordType::kHead, -1, {}}}), HasSubstr(reason));
  EXPECT_THAT(refused({{RecordType::kHead, INT64_MAX, {}}}), HasSubstr(reason));
  EXPECT_THAT(refused({{static_cast<RecordType>(7), 0, {}}}), HasSubstr(reason));
}

TEST_F(RecordingFile, NeverOverwrites) {
  const auto file = temp_.write("mine", "precious");
  EXPECT_THAT(error_of<UserError>([&] { RecordWriter writer(file); }), HasSubstr("mine exists already"));
  EXPECT_EQ(std::filesystem::file_size(file), 8U);
  EXPECT_THAT(error_of<UserError>([&] { RecordWriter writer(temp_.path()); }), HasSubstr("exists already"));
  EXPECT_THAT(error_of<UserError>([&] { RecordWriter writer(file / "below"); }), HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace coslam::recording_file_test
