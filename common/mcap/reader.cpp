// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/mcap/reader.h"

#include <algorithm>
#include <utility>

#include "common/base/error.h"
#include "common/compression/compression.h"

namespace coslam::mcap {
namespace {

constexpr std::uint64_t kFooterLength = 20;
constexpr std::size_t kMessageHead = 22;  // channel, sequence, two times
constexpr std::uint64_t kMostChunkOctets = 1ULL << 30U;
constexpr std::uint64_t kFarthest_ns = 4'000'000'000'000'000'000;  // the year 2096: differences stay in range

// What is later counts as the farthest.
TimeNs time_of(std::uint64_t ns) { return static_cast<TimeNs>(std::min(ns, kFarthest_ns)); }

}  // namespace

Reader::Reader(const std::filesystem::path& file, std::string name)
    : name_(name.empty() ? file.string() : std::move(name)) {
  stream_.open(file, std::ios::binary);
  std::error_code error;
  size_ = std::filesystem::file_size(file, error);
  if (!stream_ || error) fail("cannot be read");
  const std::string magic = octets_of(0, std::min<std::uint64_t>(size_, kMagic.size()));
  if (!magic.starts_with(kMagic.substr(0, 5))) fail("is no MCAP file");
  if (magic != kMagic) fail("is an MCAP file of another version, or its start is damaged");
  has_summary_ = read_summary();
  if (!has_summary_) scan();
  std::ranges::stable_sort(blocks_, {}, &Block::first_ns);
}

const Channel* Reader::find(std::string_view topic) const {
  const auto found = std::ranges::find_if(channels_, [&](const auto& c) { return c.second.topic == topic; });
  return found == channels_.end() ? nullptr : &found->second;
}

const Schema& Reader::schema_of(const Channel& channel) const {
  static const Schema kNone;
  const auto found = schemas_.find(channel.schema);
  return found == schemas_.end() ? kNone : found->second;
}

TimeNs Reader::first_ns() const { return blocks_.empty() ? 0 : time_of(blocks_.front().first_ns); }

void Reader::fail(const std::string& problem) const { throw UserError(name_ + ": " + problem); }

std::string Reader::octets_of(std::uint64_t offset, std::uint64_t length) {
  if (offset > size_ || length > size_ - offset) fail("is damaged: a record lies outside of the file");
  std::string octets(length, '\0');
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(offset));
  stream_.read(octets.data(), static_cast<std::streamsize>(length));
  if (!stream_) fail("cannot be read at octet " + std::to_string(offset));
  return octets;
}

std::optional<Reader::Record> Reader::record_at(std::uint64_t offset) {
  if (offset > size_ || size_ - offset < kRecordHead) return std::nullopt;
  const std::string head = octets_of(offset, kRecordHead);
  OctetReader in(head);
  Record record;
  record.opcode = in.get<Opcode>();
  record.length = in.get<std::uint64_t>();
  record.offset = offset + kRecordHead;
  return record.length <= size_ - record.offset ? std::optional(record) : std::nullopt;
}

bool Reader::read_summary() {
  const std::uint64_t end = kRecordHead + kFooterLength + kMagic.size();
  if (size_ < kMagic.size() + end) return false;
  const std::string last = octets_of(size_ - end, end);
  OctetReader in(last);
  if (in.get<Opcode>() != Opcode::kFooter || in.get<std::uint64_t>() != kFooterLength) return false;
  const Footer footer = read_footer(in);
  const std::uint64_t footer_at = size_ - end;
  if (in.rest() != kMagic || footer.summary == 0 || footer.summary > footer_at) return false;
  const std::string summary = octets_of(footer.summary, footer_at - footer.summary);
  const std::string_view footer_without_crc =
      std::string_view(last).substr(0, kRecordHead + kFooterLength - sizeof footer.crc);
  if (footer.crc != 0 && footer.crc != crc32_of(footer_without_crc, crc32_of(summary))) {
    warning_ = name_ + ": its summary is damaged, all of it is read instead";
    return false;
  }
  if (take_summary(summary)) return true;
  schemas_.clear();
  channels_.clear();
  blocks_.clear();
  return false;
}

// False: it does not list all messages.
bool Reader::take_summary(std::string_view summary) {
  std::optional<Statistics> statistics;
  OctetReader in(summary);
  while (!in.rest().empty()) {
    const auto opcode = in.get<Opcode>();
    const std::string_view content = in.get_octets(in.get<std::uint64_t>());
    if (!in.ok()) return false;
    OctetReader inner(content);
    if (opcode == Opcode::kStatistics) {
      statistics = read_statistics(inner);
    } else if (opcode == Opcode::kChunkIndex) {
      const ChunkIndex index = read_chunk_index(inner);
      if (index.length < kRecordHead) return false;
      Block block{
          Opcode::kChunk, index.first_ns, index.last_ns, index.offset + kRecordHead, index.length - kRecordHead, {}};
      for (const auto& [channel, offset] : index.index_offsets) block.channels.insert(channel);
      blocks_.push_back(std::move(block));
    } else {
      take_description(opcode, content);
    }
    if (!inner.ok()) return false;
  }
  if (!statistics) return false;
  return statistics->messages == 0 || (!blocks_.empty() && channels_.size() == statistics->channels);
}

void Reader::take_description(Opcode opcode, std::string_view content) {
  OctetReader in(content);
  if (opcode == Opcode::kSchema) {
    Schema schema = read_schema(in);
    if (in.ok()) schemas_[schema.id] = std::move(schema);
  } else if (opcode == Opcode::kChannel) {
    Channel channel = read_channel(in);
    if (in.ok()) channels_[channel.id] = std::move(channel);
  }
}

void Reader::scan() {
  std::uint64_t at = kMagic.size();
  while (true) {
    const std::optional<Record> record = record_at(at);
    if (!record) {
      warning_ = name_ + ": was cut off, what comes before octet " + std::to_string(at) + " is read";
      return;
    }
    if (record->opcode == Opcode::kDataEnd || record->opcode == Opcode::kFooter) return;
    scan_record(*record);
    at = record->offset + record->length;
  }
}

void Reader::scan_record(const Record& record) {
  switch (record.opcode) {
    case Opcode::kChunk:
      return scan_chunk(record);
    case Opcode::kMessage: {
      const std::string head = octets_of(record.offset, std::min<std::uint64_t>(record.length, kMessageHead));
      OctetReader in(head);
      const auto channel = in.get<std::uint16_t>();
      in.get<std::uint32_t>();
      const auto t_ns = in.get<std::uint64_t>();
      if (in.ok()) blocks_.push_back({Opcode::kMessage, t_ns, t_ns, record.offset, record.length, {channel}});
      return;
    }
    case Opcode::kSchema:
    case Opcode::kChannel:
      return take_description(record.opcode, octets_of(record.offset, record.length));
    default:
      return;  // of no use here
  }
}

// Its times, and the schemas and channels that it describes.
void Reader::scan_chunk(const Record& record) {
  Block block{Opcode::kChunk, 0, 0, record.offset, record.length, {}};
  const std::string times = octets_of(record.offset, std::min<std::uint64_t>(record.length, 16));
  OctetReader head(times);
  block.first_ns = head.get<std::uint64_t>();
  block.last_ns = head.get<std::uint64_t>();
  const std::string records = messages_of_chunk(block);
  OctetReader in(records);
  while (!in.rest().empty()) {
    const auto opcode = in.get<Opcode>();
    const std::string_view content = in.get_octets(in.get<std::uint64_t>());
    if (!in.ok()) fail("is damaged: the chunk at octet " + std::to_string(block.offset) + " ends within a record");
    take_description(opcode, content);
    OctetReader message(content);
    if (opcode == Opcode::kMessage) block.channels.insert(message.get<std::uint16_t>());
  }
  blocks_.push_back(std::move(block));
}

// The records in a chunk, decompressed and checked.
std::string Reader::messages_of_chunk(const Block& block) {
  const std::string chunk = octets_of(block.offset, block.length);
  const std::string chunk_name = "the chunk at octet " + std::to_string(block.offset);
  OctetReader in(chunk);
  in.get_octets(2 * sizeof(std::uint64_t));  // the times
  const auto size = in.get<std::uint64_t>();
  const auto crc = in.get<std::uint32_t>();
  const std::string compression(in.get_text());
  const std::string_view octets = in.get_octets(in.get<std::uint64_t>());
  if (!in.ok() || size > kMostChunkOctets) fail("is damaged: " + chunk_name + " is no chunk");
  std::optional<std::string> records;
  if (compression.empty()) {
    if (octets.size() == size) records = octets;
  } else if (compression == "zstd") {
    records = zstd_decompressed(octets, size);
  } else if (compression == "lz4") {
    records = lz4_decompressed(octets, size);
  } else {
    fail("is compressed with " + compression + ", which is not known here: zstd and lz4 are");
  }
  if (!records || (crc != 0 && crc != crc32_of(*records)))
    fail("is damaged: " + chunk_name + " is not what was written");
  return std::move(*records);
}

void Reader::seek(std::set<std::uint16_t> channels, TimeNs from_ns) {
  wanted_ = std::move(channels);
  from_ns_ = static_cast<std::uint64_t>(std::max<TimeNs>(from_ns, 0));
  next_block_ = 0;
  waiting_ = {};
}

bool Reader::wanted(const Block& block) const {
  if (block.last_ns < from_ns_) return false;
  if (wanted_.empty() || block.channels.empty()) return true;
  return std::ranges::any_of(block.channels, [&](std::uint16_t c) { return wanted_.contains(c); });
}

void Reader::load(const Block& block) {
  if (!wanted(block)) return;
  if (block.opcode == Opcode::kMessage) {
    const auto octets = std::make_shared<const std::string>(octets_of(block.offset, block.length));
    return add_message(octets, *octets);
  }
  const auto octets = std::make_shared<const std::string>(messages_of_chunk(block));
  OctetReader in(*octets);
  while (!in.rest().empty()) {
    const auto opcode = in.get<Opcode>();
    const std::string_view content = in.get_octets(in.get<std::uint64_t>());
    if (!in.ok()) fail("is damaged: the chunk at octet " + std::to_string(block.offset) + " ends within a record");
    if (opcode == Opcode::kMessage) add_message(octets, content);
  }
}

void Reader::add_message(const std::shared_ptr<const std::string>& octets, std::string_view message) {
  OctetReader in(message);
  const auto channel = in.get<std::uint16_t>();
  in.get<std::uint32_t>();
  const auto t_ns = in.get<std::uint64_t>();
  in.get<std::uint64_t>();
  if (!in.ok()) fail("is damaged: a message without its head");
  if (t_ns < from_ns_ || (!wanted_.empty() && !wanted_.contains(channel))) return;
  waiting_.push({t_ns, order_++, octets, message});
}

std::optional<Message> Reader::next() {
  while (next_block_ < blocks_.size() && (waiting_.empty() || blocks_[next_block_].first_ns <= waiting_.top().t_ns)) {
    load(blocks_[next_block_++]);
  }
  if (waiting_.empty()) return std::nullopt;
  OctetReader in(waiting_.top().message);
  Message message;
  message.channel = in.get<std::uint16_t>();
  message.sequence = in.get<std::uint32_t>();
  message.noted_ns = time_of(in.get<std::uint64_t>());
  message.published_ns = time_of(in.get<std::uint64_t>());
  message.octets = in.rest();
  waiting_.pop();
  return message;
}

}  // namespace coslam::mcap
