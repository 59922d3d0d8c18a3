// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/time.h"
#include "common/mcap/records.h"

namespace coslam::mcap {

enum class Compression : std::uint8_t { kNone, kZstd };

struct WriterConfig {
  std::string profile = "ros2";  // profile of the whole file; "" where it is not all ROS 2 messages
  std::string library = "coslam";
  Compression compression = Compression::kZstd;
  std::size_t chunk_bytes = 1U << 20U;  // size of the messages in a chunk before compression
};

// Writes an MCAP file, octets in order to `out`: chunks, each followed by the index of its messages, and at the end a
// summary with which readers find any time and topic without reading the rest. Not thread-safe.
class Writer {
 public:
  using Out = std::function<void(std::string_view)>;
  explicit Writer(Out out, WriterConfig config = {});
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  // Adds a schema at any time; a schema or channel that was added before gets the number that it has. encoding:
  // "ros2msg", "jsonschema".
  std::uint16_t add_schema(const std::string& name, const std::string& encoding, const std::string& text);
  // schema: 0 for none. encoding: "cdr", "json".
  std::uint16_t add_channel(const std::string& topic, const std::string& encoding, std::uint16_t schema);

  // Writes to a channel that was added; times before 0 count as 0. Messages may come in any order of time.
  void write(std::uint16_t channel, TimeNs t_ns, std::span<const std::uint8_t> octets);
  void write(std::uint16_t channel, TimeNs t_ns, std::string_view octets);

  // Brings out what is gathered, so that who follows the file reads it.
  void flush();
  // The end of the file. Without it there is no summary, and readers have to go through the file.
  void close();

 private:
  struct Entry {
    std::uint64_t t_ns, offset;
  };

  void put(std::string_view octets);
  void put_in_chunk(const std::string& record);
  std::string compressed_chunk() const;
  void write_indexes(ChunkIndex& chunk);
  Statistics statistics() const;

  const Out out_;
  const WriterConfig config_;
  std::uint64_t written_ = 0;
  std::uint32_t crc_ = 0;  // checksum of everything written so far
  std::vector<Schema> schemas_;
  std::vector<Channel> channels_;
  std::map<std::uint16_t, std::uint32_t> sequence_;  // messages of each channel so far
  std::vector<ChunkIndex> chunks_;

  std::string chunk_;  // messages of the open chunk
  std::map<std::uint16_t, std::vector<Entry>> entries_;
  std::uint64_t chunk_first_ns_ = 0, chunk_last_ns_ = 0;
};

}  // namespace coslam::mcap
