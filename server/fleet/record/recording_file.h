// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <vector>

#include "common/base/time.h"

// A recording as a file. All numbers are little endian:
//
//   8 octets "CoSLAMrc", uint32 format version
//   records, each:  uint32 length of the payload, uint8 type, int64 time, uint32 CRC32 of these 13 octets,
//                   the payload, uint32 CRC32 of the payload
//
// The first record is the head. A record with the type kEnd is the last one of a recording that was ended, not cut off.
namespace coslam {

constexpr std::uint32_t kRecordingVersion = 1;  // raised by any change, also of a payload

enum class RecordType : std::uint8_t { kHead, kHello, kFrame, kStatus, kSilent, kGone, kEnd };

struct Record {
  RecordType type = RecordType::kEnd;
  TimeNs t_ns = 0;  // since the recording began
  std::vector<std::uint8_t> payload;
};

// Appends records to a new file. Thread-compatible.
class RecordWriter {
 public:
  static constexpr std::size_t kMostPayload_bytes = 1 << 24;  // far more than any event has

  // Throws UserError when the file is there already or cannot be made.
  explicit RecordWriter(std::filesystem::path file);
  ~RecordWriter();
  RecordWriter(const RecordWriter&) = delete;
  RecordWriter& operator=(const RecordWriter&) = delete;

  // 0, or the errno of what went wrong; nothing of this record is left in the file then.
  int write(const Record& record);
  void remove();  // the file

 private:
  int write(std::span<const std::uint8_t> octets);

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::int64_t whole_bytes_ = 0;  // up to the end of the last record
};

// Reads them in order and trusts nothing. Thread-compatible.
class RecordReader {
 public:
  // Throws UserError when there is no such file, or when it is no recording of this version.
  explicit RecordReader(std::filesystem::path file);

  // The next whole record; empty at the end of the file. Throws UserError when it is damaged.
  std::optional<Record> next();
  // Whether the end of the file came within a record.
  bool cut_off() const { return cut_off_; }
  // Throws UserError: the file, which record was read last, and this.
  [[noreturn]] void fail(const std::string& reason) const;

 private:
  bool read(std::span<std::uint8_t> octets);

  std::filesystem::path file_;
  std::ifstream stream_;
  std::uint64_t left_bytes_ = 0;  // in the file
  std::uint64_t number_ = 0;      // number of the record that was read last, from 1
  TimeNs last_ns_ = 0;
  bool cut_off_ = false;
};

}  // namespace coslam
