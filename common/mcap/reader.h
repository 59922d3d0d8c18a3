// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <queue>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.h"
#include "common/mcap/records.h"

namespace coslam::mcap {

struct Message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  TimeNs noted_ns = 0, published_ns = 0;
  std::string octets;
};

// Reads an MCAP file, by its summary where it has one, else by going through it once first. Not thread-safe.
class Reader {
 public:
  // Throws UserError, one sentence: not there, no MCAP file, of another version, damaged. `name` is what it calls the
  // file; empty: by its path.
  explicit Reader(const std::filesystem::path& file, std::string name = {});

  const std::map<std::uint16_t, Channel>& channels() const { return channels_; }
  // The first one of that topic; null: there is none.
  const Channel* find(std::string_view topic) const;
  const Schema& schema_of(const Channel& channel) const;  // an empty one: it has none
  bool has_summary() const { return has_summary_; }
  TimeNs first_ns() const;  // when the first message of all was noted; 0: there is none
  // A sentence when the file was cut off or its summary is damaged; what there is can be read all the same.
  const std::string& warning() const { return warning_; }

  // Continues with the messages of these channels (none: of all) noted at from_ns or later, ordered by that time.
  void seek(std::set<std::uint16_t> channels = {}, TimeNs from_ns = 0);
  // Next message; empty at the end. Throws UserError: a chunk is damaged, or compressed in a way that is not known
  // here.
  std::optional<Message> next();

 private:
  struct Record {
    Opcode opcode{};
    std::uint64_t offset = 0, length = 0;  // position of the content
  };
  // A chunk, or a message outside of any.
  struct Block {
    Opcode opcode{};
    std::uint64_t first_ns = 0, last_ns = 0;
    std::uint64_t offset = 0, length = 0;  // position of the content
    std::set<std::uint16_t> channels;      // channels with messages in it; empty: not known
  };
  struct Waiting {
    std::uint64_t t_ns = 0, order = 0;
    std::shared_ptr<const std::string> octets;
    std::string_view message;  // in the octets
  };
  struct Later {
    bool operator()(const Waiting& a, const Waiting& b) const {
      return a.t_ns != b.t_ns ? a.t_ns > b.t_ns : a.order > b.order;
    }
  };

  [[noreturn]] void fail(const std::string& problem) const;
  std::optional<Record> record_at(std::uint64_t offset);  // empty: the file ends before it does
  std::string octets_of(std::uint64_t offset, std::uint64_t length);

  bool read_summary();
  bool take_summary(std::string_view summary);
  void scan();
  void scan_record(const Record& record);
  void scan_chunk(const Record& record);
  void take_description(Opcode opcode, std::string_view content);

  std::string messages_of_chunk(const Block& block);
  bool wanted(const Block& block) const;
  void load(const Block& block);
  void add_message(const std::shared_ptr<const std::string>& octets, std::string_view message);

  const std::string name_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  bool has_summary_ = false;
  std::string warning_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::vector<Block> blocks_;  // ordered by first time

  std::set<std::uint16_t> wanted_;
  std::uint64_t from_ns_ = 0, order_ = 0;
  std::size_t next_block_ = 0;
  std::priority_queue<Waiting, std::vector<Waiting>, Later> waiting_;
};

}  // namespace coslam::mcap
