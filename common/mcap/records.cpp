// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/records.h"

#include <zlib.h>

namespace coslam::mcap {

std::string record(Opcode opcode, std::string_view content) {
  OctetWriter out;
  out.put(opcode);
  out.put(static_cast<std::uint64_t>(content.size()));
  out.put_octets(content);
  return out.octets();
}

std::string record_of(const Schema& schema) {
  OctetWriter out;
  out.put(schema.id);
  out.put_text(schema.name);
  out.put_text(schema.encoding);
  out.put_text(schema.text);
  return record(Opcode::kSchema, out.octets());
}

std::string record_of(const Channel& channel) {
  OctetWriter out;
  out.put(channel.id);
  out.put(channel.schema);
  out.put_text(channel.topic);
  out.put_text(channel.encoding);
  out.put_map(channel.metadata);
  return record(Opcode::kChannel, out.octets());
}

std::string record_of(const ChunkIndex& index) {
  OctetWriter out;
  out.put(index.first_ns);
  out.put(index.last_ns);
  out.put(index.offset);
  out.put(index.length);
  out.put_map(index.index_offsets);
  out.put(index.index_length);
  out.put_text(index.compression);
  out.put(index.compressed);
  out.put(index.uncompressed);
  return record(Opcode::kChunkIndex, out.octets());
}

std::string record_of(const Statistics& statistics) {
  OctetWriter out;
  out.put(statistics.messages);
  out.put(statistics.schemas);
  out.put(statistics.channels);
  out.put(statistics.attachments);
  out.put(statistics.metadata);
  out.put(statistics.chunks);
  out.put(statistics.first_ns);
  out.put(statistics.last_ns);
  out.put_map(statistics.of_channels);
  return record(Opcode::kStatistics, out.octets());
}

Schema read_schema(OctetReader& in) {
  Schema schema;
  schema.id = in.get<std::uint16_t>();
  schema.name = in.get_text();
  schema.encoding = in.get_text();
  schema.text = in.get_text();
  return schema;
}

Channel read_channel(OctetReader& in) {
  Channel channel;
  channel.id = in.get<std::uint16_t>();
  channel.schema = in.get<std::uint16_t>();
  channel.topic = in.get_text();
  channel.encoding = in.get_text();
  channel.metadata = in.get_map<std::string, std::string>();
  return channel;
}

ChunkIndex read_chunk_index(OctetReader& in) {
  ChunkIndex index;
  index.first_ns = in.get<std::uint64_t>();
  index.last_ns = in.get<std::uint64_t>();
  index.offset = in.get<std::uint64_t>();
  index.length = in.get<std::uint64_t>();
  index.index_offsets = in.get_map<std::uint16_t, std::uint64_t>();
  index.index_length = in.get<std::uint64_t>();
  index.compression = in.get_text();
  index.compressed = in.get<std::uint64_t>();
  index.uncompressed = in.get<std::uint64_t>();
  return index;
}

Statistics read_statistics(OctetReader& in) {
  Statistics s;
  s.messages = in.get<std::uint64_t>();
  s.schemas = in.get<std::uint16_t>();
  s.channels = in.get<std::uint32_t>();
  s.attachments = in.get<std::uint32_t>();
  s.metadata = in.get<std::uint32_t>();
  s.chunks = in.get<std::uint32_t>();
  s.first_ns = in.get<std::uint64_t>();
  s.last_ns = in.get<std::uint64_t>();
  s.of_channels = in.get_map<std::uint16_t, std::uint64_t>();
  return s;
}

Footer read_footer(OctetReader& in) {
  Footer footer;
  footer.summary = in.get<std::uint64_t>();
  footer.offsets = in.get<std::uint64_t>();
  footer.crc = in.get<std::uint32_t>();
  return footer;
}

std::uint32_t crc32_of(std::string_view octets, std::uint32_t before) {
  return static_cast<std::uint32_t>(crc32_z(before, reinterpret_cast<const Bytef*>(octets.data()), octets.size()));
}

}  // namespace coslam::mcap
