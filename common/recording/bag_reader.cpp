// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recording/bag_reader.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/compression/compression.h"
#include "common/mcap/records.h"
#include "common/recording/containers.h"

namespace coslam::recording {
namespace {

constexpr std::uint64_t kMostChunkOctets = 1ULL << 30U;
constexpr std::uint64_t kMostHeaderOctets = 1ULL << 20U;
constexpr std::size_t kMostConnections = 1U << 16U;

}  // namespace

BagReader::BagReader(const std::filesystem::path& file, std::string name) : name_(std::move(name)) {
  stream_.open(file, std::ios::binary);
  std::error_code error;
  size_ = std::filesystem::file_size(file, error);
  if (!stream_ || error) fail("cannot be read");
  const std::string magic = octets_of(0, std::min<std::uint64_t>(size_, kBagMagic.size()));
  if (!magic.starts_with(kBagMagic.substr(0, kBagMagic.find('V')))) fail("is no bag of ROS 1");
  if (magic != kBagMagic) fail("is a bag of an older version than 2.0, which is not read; rosbag reindex converts it");
  const auto bag_header = record_at(kBagMagic.size());
  if (!bag_header || bag_header->fields.op() != BagOp::kBagHeader) fail("is damaged: it has no header");
  if (!bag_header->fields.text("encryptor").empty()) fail("is an encrypted bag, which is not read");
  if (!read_index(*bag_header)) scan(bag_header->end());
  std::ranges::stable_sort(chunks_, {}, &Chunk::first_ns);
}

void BagReader::fail(const std::string& problem) const { throw UserError(name_ + ": " + problem); }

std::string BagReader::octets_of(std::uint64_t offset, std::uint64_t length) {
  if (offset > size_ || length > size_ - offset) fail("is damaged: a record lies outside of the file");
  std::string octets(length, '\0');
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(offset));
  stream_.read(octets.data(), static_cast<std::streamsize>(length));
  if (!stream_) fail("cannot be read at octet " + std::to_string(offset));
  return octets;
}

std::optional<BagReader::Record> BagReader::record_at(std::uint64_t offset) {
  const auto length_at = [&](std::uint64_t at) -> std::optional<std::uint32_t> {
    if (at > size_ || size_ - at < sizeof(std::uint32_t)) return std::nullopt;
    return mcap::OctetReader(octets_of(at, sizeof(std::uint32_t))).get<std::uint32_t>();
  };
  const auto header_length = length_at(offset);
  if (!header_length || *header_length > kMostHeaderOctets) return std::nullopt;
  const std::uint64_t header_at = offset + sizeof(std::uint32_t);
  const auto length = length_at(header_at + *header_length);
  if (!length) return std::nullopt;
  const std::uint64_t data = header_at + *header_length + sizeof(std::uint32_t);
  if (*length > size_ - data) return std::nullopt;
  const std::string header = octets_of(header_at, *header_length);
  Record record{{header.begin(), header.end()}, {}, data, *length};
  auto fields = BagFields::read({record.header.data(), record.header.size()});
  if (!fields) return std::nullopt;
  record.fields = std::move(*fields);
  return record;
}

// False: there is no index, or not all of it.
bool BagReader::read_index(const Record& bag_header) {
  const auto index = bag_header.fields.long_number("index_pos");
  const auto connections = bag_header.fields.number("conn_count"), chunks = bag_header.fields.number("chunk_count");
  if (!index || *index < bag_header.end() || !connections || !chunks) return false;
  std::uint32_t connections_read = 0;
  std::set<std::uint64_t> offsets;
  for (std::uint64_t at = *index; at < size_;) {
    const auto record = record_at(at);
    if (!record) break;
    if (record->fields.op() == BagOp::kConnection) {
      add_connection(record->fields, octets_of(record->data, record->length));
      ++connections_read;
    } else {
      auto chunk = read_chunk_info(*record);
      if (!chunk || !offsets.insert(chunk->offset).second) break;
      chunks_.push_back(std::move(*chunk));
    }
    at = record->end();
  }
  if (connections_read == *connections && chunks_.size() == *chunks) return true;
  topics_.clear();
  connections_.clear();
  chunks_.clear();
  return false;
}

std::optional<BagReader::Chunk> BagReader::read_chunk_info(const Record& record) {
  const auto offset = record.fields.long_number("chunk_pos");
  const auto first_ns = record.fields.time_ns("start_time");
  if (record.fields.op() != BagOp::kChunkInfo || !offset || !first_ns) return std::nullopt;
  Chunk chunk{*first_ns, *offset, {}};
  const std::string data = octets_of(record.data, record.length);
  mcap::OctetReader in(data);
  while (in.ok() && !in.rest().empty()) {
    chunk.connections.insert(in.get<Connection>());
    in.get<std::uint32_t>();  // messages of it
  }
  return in.ok() ? std::optional(std::move(chunk)) : std::nullopt;
}

void BagReader::scan(std::uint64_t at) {
  while (at < size_) {
    const auto record = record_at(at);
    if (!record) {
      warning_ = name_ + ": was cut off or is damaged; what comes before octet " + std::to_string(at) + " is read";
      return;
    }
    scan_record(*record, at);
    at = record->end();
  }
  if (warning_.empty()) warning_ = name_ + ": was not closed and has no index; all of it is read instead";
}

void BagReader::scan_record(const Record& record, std::uint64_t at) {
  Chunk chunk{std::numeric_limits<TimeNs>::max(), at, {}};
  const auto take = [&](const BagFields& fields, std::string_view data) {
    if (fields.op() == BagOp::kConnection) add_connection(fields, data);
    if (fields.op() != BagOp::kMessage) return;
    const auto connection = fields.number("conn");
    const auto t_ns = fields.time_ns("time");
    if (!connection || !t_ns) return;
    chunk.connections.insert(*connection);
    chunk.first_ns = std::min(chunk.first_ns, *t_ns);
  };
  if (record.fields.op() == BagOp::kChunk) {
    try {
      for_each_record(records_of_chunk(record), take);
    } catch (const UserError& e) {
      warning_ = std::string(e.what()) + "; that chunk is passed over";
      return;
    }
  } else if (record.fields.op() == BagOp::kConnection) {
    take(record.fields, octets_of(record.data, record.length));
  } else {
    take(record.fields, {});
  }
  if (!chunk.connections.empty()) chunks_.push_back(std::move(chunk));
}

void BagReader::add_connection(const BagFields& fields, std::string_view data) {
  const auto connection = fields.number("conn");
  const auto described = BagFields::read(data);
  if (!connection || !described || topics_.size() >= kMostConnections) return;
  const std::size_t topic =
      place_of({std::string(fields.text("topic")), std::string(described->text("type")), "ros1"}, topics_);
  connections_.resize(topics_.size());
  connections_[topic].insert(*connection);
}

// The records in a chunk, decompressed.
std::string BagReader::records_of_chunk(const Record& record) {
  const std::string chunk_name = "the chunk at octet " + std::to_string(record.data);
  const auto size = record.fields.number("size");
  if (record.fields.op() != BagOp::kChunk || !size || *size > kMostChunkOctets) {
    fail("is damaged: " + chunk_name + " is no chunk");
  }
  std::string octets = octets_of(record.data, record.length);
  const std::string compression(record.fields.text("compression"));
  std::optional<std::string> records;
  if (compression == "none") {
    if (octets.size() == *size) records = std::move(octets);
  } else if (compression == "bz2") {
    records = bzip2_decompressed(octets, *size);
  } else if (compression == "lz4") {
    records = lz4_decompressed(octets, *size);
  } else {
    fail("is compressed with " + compression + ", which is not known here: bz2 and lz4 are");
  }
  if (!records) fail("is damaged: " + chunk_name + " is not what was written");
  return std::move(*records);
}

template <class Visit>
void BagReader::for_each_record(std::string_view records, const Visit& visit) const {
  mcap::OctetReader in(records);
  while (!in.rest().empty()) {
    const auto fields = BagFields::read(in.get_text());
    const std::string_view data = in.get_text();
    if (!in.ok() || !fields) fail("is damaged: a chunk ends within a record");
    visit(*fields, data);
  }
}

void BagReader::play(std::size_t topic) {
  played_ = topic;
  next_chunk_ = 0;
  waiting_ = {};
}

void BagReader::load(const Chunk& chunk) {
  const std::set<Connection>& wanted = connections_.at(played_);
  if (std::ranges::none_of(chunk.connections, [&](Connection c) { return wanted.contains(c); })) return;
  const auto record = record_at(chunk.offset);
  if (!record) fail("is damaged: there is no chunk at octet " + std::to_string(chunk.offset));
  const auto add = [&](const BagFields& fields, const std::shared_ptr<const std::string>& octets,
                       std::string_view data) {
    const auto connection = fields.number("conn");
    const auto t_ns = fields.time_ns("time");
    if (fields.op() != BagOp::kMessage || !connection || !t_ns || !wanted.contains(*connection)) return;
    waiting_.push({*t_ns, order_++, octets, data});
  };
  if (record->fields.op() == BagOp::kMessage) {
    const auto octets = std::make_shared<const std::string>(octets_of(record->data, record->length));
    return add(record->fields, octets, *octets);
  }
  const auto octets = std::make_shared<const std::string>(records_of_chunk(*record));
  for_each_record(*octets, [&](const BagFields& fields, std::string_view data) { add(fields, octets, data); });
}

std::optional<Message> BagReader::next() {
  while (next_chunk_ < chunks_.size() && (waiting_.empty() || chunks_[next_chunk_].first_ns <= waiting_.top().t_ns)) {
    try {
      load(chunks_[next_chunk_++]);
    } catch (const UserError& e) {
      if (order_ == 0) throw;
      // The chunks behind it may be sound.
      log_warn(std::string(e.what()) + "; passed over");
    }
  }
  if (waiting_.empty()) return std::nullopt;
  Message message{waiting_.top().t_ns, std::string(waiting_.top().message)};
  waiting_.pop();
  return message;
}

std::unique_ptr<Recording> open_bag(const std::filesystem::path& file, const std::string& name) {
  return std::make_unique<BagReader>(file, name);
}

}  // namespace coslam::recording
