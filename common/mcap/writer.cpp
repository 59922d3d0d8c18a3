// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/writer.h"

#include <algorithm>

#include "common/base/check.h"
#include "common/compression/compression.h"

namespace coslam::mcap {

Writer::Writer(Out out, WriterConfig config) : out_(std::move(out)), config_(std::move(config)) {
  put(kMagic);
  OctetWriter header;
  header.put_text(config_.profile);
  header.put_text(config_.library);
  put(record(Opcode::kHeader, header.octets()));
}

Writer::~Writer() = default;

std::uint16_t Writer::add_schema(const std::string& name, const std::string& encoding, const std::string& text) {
  const auto same = [&](const Schema& s) { return s.name == name && s.encoding == encoding && s.text == text; };
  const auto known = std::ranges::find_if(schemas_, same);
  if (known != schemas_.end()) return known->id;
  COSLAM_CHECK(schemas_.size() < UINT16_MAX, "more schemas than an MCAP file can number");
  schemas_.push_back({static_cast<std::uint16_t>(schemas_.size() + 1), name, encoding, text});
  put_in_chunk(record_of(schemas_.back()));
  return schemas_.back().id;
}

std::uint16_t Writer::add_channel(const std::string& topic, const std::string& encoding, std::uint16_t schema) {
  const auto same = [&](const Channel& c) { return c.topic == topic && c.encoding == encoding && c.schema == schema; };
  const auto known = std::ranges::find_if(channels_, same);
  if (known != channels_.end()) return known->id;
  COSLAM_CHECK(schema <= schemas_.size(), "a channel of a schema that was not added");
  COSLAM_CHECK(channels_.size() < UINT16_MAX, "more channels than an MCAP file can number");
  channels_.push_back({static_cast<std::uint16_t>(channels_.size()), schema, topic, encoding, {}});
  put_in_chunk(record_of(channels_.back()));
  return channels_.back().id;
}

void Writer::write(std::uint16_t channel, TimeNs t_ns, std::span<const std::uint8_t> octets) {
  write(channel, t_ns, std::string_view(reinterpret_cast<const char*>(octets.data()), octets.size()));
}

void Writer::write(std::uint16_t channel, TimeNs t_ns, std::string_view octets) {
  COSLAM_CHECK(channel < channels_.size(), "a message of a channel that was not added");
  const auto t = static_cast<std::uint64_t>(std::max<TimeNs>(t_ns, 0));
  const bool first = entries_.empty();
  chunk_first_ns_ = first ? t : std::min(chunk_first_ns_, t);
  chunk_last_ns_ = first ? t : std::max(chunk_last_ns_, t);
  entries_[channel].push_back({t, chunk_.size()});
  OctetWriter message;
  message.put(channel);
  message.put(sequence_[channel]++);
  message.put(t);  // when it was noted
  message.put(t);  // when it was published
  message.put_octets(octets);
  put_in_chunk(record(Opcode::kMessage, message.octets()));
  if (chunk_.size() >= config_.chunk_bytes) flush();
}

void Writer::flush() {
  if (entries_.empty()) return;  // a chunk of schemas and channels alone would have no time
  const std::string octets = compressed_chunk();
  ChunkIndex chunk;
  chunk.first_ns = chunk_first_ns_;
  chunk.last_ns = chunk_last_ns_;
  chunk.offset = written_;
  chunk.compression = config_.compression == Compression::kZstd ? "zstd" : "";
  chunk.compressed = octets.size();
  chunk.uncompressed = chunk_.size();
  OctetWriter out;
  out.put(chunk.first_ns);
  out.put(chunk.last_ns);
  out.put(chunk.uncompressed);
  out.put(crc32_of(chunk_));
  out.put_text(chunk.compression);
  out.put(chunk.compressed);
  out.put_octets(octets);
  put(record(Opcode::kChunk, out.octets()));
  chunk.length = written_ - chunk.offset;
  write_indexes(chunk);
  chunks_.push_back(std::move(chunk));
  chunk_.clear();
  entries_.clear();
  chunk_first_ns_ = chunk_last_ns_ = 0;
}

void Writer::write_indexes(ChunkIndex& chunk) {
  const std::uint64_t start = written_;
  for (auto& [channel, entries] : entries_) {
    std::ranges::stable_sort(entries, {}, &Entry::t_ns);
    chunk.index_offsets[channel] = written_;
    OctetWriter list;
    for (const Entry& entry : entries) {
      list.put(entry.t_ns);
      list.put(entry.offset);
    }
    OctetWriter index;
    index.put(channel);
    index.put_text(list.octets());
    put(record(Opcode::kMessageIndex, index.octets()));
  }
  chunk.index_length = written_ - start;
}

Statistics Writer::statistics() const {
  Statistics s;
  s.schemas = static_cast<std::uint16_t>(schemas_.size());
  s.channels = static_cast<std::uint32_t>(channels_.size());
  s.chunks = static_cast<std::uint32_t>(chunks_.size());
  for (const auto& [channel, count] : sequence_) {
    s.of_channels[channel] = count;
    s.messages += count;
  }
  bool first = true;
  for (const ChunkIndex& chunk : chunks_) {
    s.first_ns = first ? chunk.first_ns : std::min(s.first_ns, chunk.first_ns);
    s.last_ns = std::max(s.last_ns, chunk.last_ns);
    first = false;
  }
  return s;
}

void Writer::close() {
  flush();
  OctetWriter end;
  end.put(crc_);
  put(record(Opcode::kDataEnd, end.octets()));

  const std::uint64_t summary = written_;
  std::string octets, offsets;
  const auto add_group = [&](Opcode opcode, const auto& items) {
    if (std::empty(items)) return;
    const std::uint64_t start = octets.size();
    for (const auto& item : items) octets += record_of(item);
    OctetWriter offset;
    offset.put(opcode);
    offset.put(summary + start);
    offset.put(octets.size() - start);
    offsets += record(Opcode::kSummaryOffset, offset.octets());
  };
  add_group(Opcode::kSchema, schemas_);
  add_group(Opcode::kChannel, channels_);
  add_group(Opcode::kStatistics, std::vector{statistics()});
  add_group(Opcode::kChunkIndex, chunks_);
  const std::uint64_t first_offset = summary + octets.size();
  octets += offsets;

  OctetWriter footer;
  footer.put(summary);
  footer.put(first_offset);
  footer.put(std::uint32_t{0});
  const std::string whole = record(Opcode::kFooter, footer.octets());
  const std::string_view without_crc = std::string_view(whole).substr(0, whole.size() - sizeof(std::uint32_t));
  octets += without_crc;
  const std::uint32_t crc = crc32_of(octets);
  put(octets);
  OctetWriter last;
  last.put(crc);
  last.put_octets(kMagic);
  put(last.octets());
}

std::string Writer::compressed_chunk() const {
  return config_.compression == Compression::kZstd ? zstd_compressed(chunk_) : chunk_;
}

void Writer::put_in_chunk(const std::string& record) { chunk_ += record; }

void Writer::put(std::string_view octets) {
  crc_ = crc32_of(octets, crc_);
  written_ += octets.size();
  out_(octets);
}

}  // namespace coslam::mcap
