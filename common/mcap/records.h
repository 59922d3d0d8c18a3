// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// The records of MCAP files (https://mcap.dev/spec), little endian: an octet that says which, the length of the content
// in eight octets, and the content. Octets are held in std::string.
namespace coslam::mcap {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");

inline constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
inline constexpr std::size_t kRecordHead = 9;

enum class Opcode : std::uint8_t {
  kHeader = 1,
  kFooter,
  kSchema,
  kChannel,
  kMessage,
  kChunk,
  kMessageIndex,
  kChunkIndex,
  kAttachment,
  kAttachmentIndex,
  kStatistics,
  kMetadata,
  kMetadataIndex,
  kSummaryOffset,
  kDataEnd
};

using Texts = std::map<std::string, std::string>;

// Definition of a message type: "ros2msg" and a definition, or "jsonschema" and a schema.
struct Schema {
  std::uint16_t id = 0;  // 0 is none
  std::string name, encoding, text;
};

struct Channel {
  std::uint16_t id = 0, schema = 0;
  std::string topic, encoding;  // encoding of the messages: "cdr", "json"
  Texts metadata;
};

// A chunk and where its messages are listed. Offsets are from the start of the file, times nanoseconds.
struct ChunkIndex {
  std::uint64_t first_ns = 0, last_ns = 0;
  std::uint64_t offset = 0, length = 0;  // position of the whole record
  std::map<std::uint16_t, std::uint64_t> index_offsets;
  std::uint64_t index_length = 0;
  std::string compression;
  std::uint64_t compressed = 0, uncompressed = 0;
};

struct Statistics {
  std::uint64_t messages = 0;
  std::uint16_t schemas = 0;
  std::uint32_t channels = 0, attachments = 0, metadata = 0, chunks = 0;
  std::uint64_t first_ns = 0, last_ns = 0;
  std::map<std::uint16_t, std::uint64_t> of_channels;
};

struct Footer {
  std::uint64_t summary = 0, offsets = 0;  // start of these sections; 0: absent
  std::uint32_t crc = 0;
};

class OctetWriter {
 public:
  template <class T>
  void put(T value) {
    char octets[sizeof(T)];
    std::memcpy(octets, &value, sizeof(T));
    octets_.append(octets, sizeof(T));
  }
  void put_text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    octets_.append(text);
  }
  void put_octets(std::string_view octets) { octets_.append(octets); }
  template <class Key, class Value>
  void put_map(const std::map<Key, Value>& map) {
    OctetWriter entries;
    for (const auto& [key, value] : map) {
      entries.put_item(key);
      entries.put_item(value);
    }
    put_text(entries.octets_);
  }

  const std::string& octets() const { return octets_; }

 private:
  void put_item(const std::string& text) { put_text(text); }
  template <class T>
  void put_item(T number) {
    put(number);
  }

  std::string octets_;
};

// Reads values from octets. After the first one that is not there everything reads as empty and ok() is false.
class OctetReader {
 public:
  explicit OctetReader(std::string_view octets) : octets_(octets) {}

  bool ok() const { return ok_; }
  std::string_view rest() const { return octets_; }
  template <class T>
  T get() {
    T value{};
    const std::string_view octets = get_octets(sizeof(T));
    if (ok_) std::memcpy(&value, octets.data(), sizeof(T));
    return value;
  }
  std::string_view get_octets(std::uint64_t count) {
    if (count > octets_.size()) ok_ = false;
    if (!ok_) return {};
    const std::string_view taken = octets_.substr(0, count);
    octets_.remove_prefix(count);
    return taken;
  }
  std::string_view get_text() { return get_octets(get<std::uint32_t>()); }
  template <class Key, class Value>
  std::map<Key, Value> get_map() {
    std::map<Key, Value> map;
    OctetReader entries(get_text());
    while (entries.ok() && !entries.octets_.empty()) {
      Key key = entries.get_item(static_cast<Key*>(nullptr));
      map[std::move(key)] = entries.get_item(static_cast<Value*>(nullptr));
    }
    ok_ = ok_ && entries.ok();
    return map;
  }

 private:
  std::string get_item(std::string* /*kind*/) { return std::string(get_text()); }
  template <class T>
  T get_item(T* /*kind*/) {
    return get<T>();
  }

  std::string_view octets_;
  bool ok_ = true;
};

// Whole records.
std::string record(Opcode opcode, std::string_view content);
std::string record_of(const Schema& schema);
std::string record_of(const Channel& channel);
std::string record_of(const ChunkIndex& index);
std::string record_of(const Statistics& statistics);

// Decodes the content of a record; truncated content reads as empty, and `in` is not ok() afterwards.
Schema read_schema(OctetReader& in);
Channel read_channel(OctetReader& in);
ChunkIndex read_chunk_index(OctetReader& in);
Statistics read_statistics(OctetReader& in);
Footer read_footer(OctetReader& in);

std::uint32_t crc32_of(std::string_view octets, std::uint32_t before = 0);

}  // namespace coslam::mcap
