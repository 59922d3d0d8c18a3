// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <queue>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/recording/bag_records.h"
#include "common/recording/recording.h"

namespace coslam::recording {

// A bag of ROS 1, version 2.0, by its index where it has one, else by going through it once first. Chunks may be plain,
// bz2 or lz4.
class BagReader final : public Recording {
 public:
  // Throws UserError: no bag, of another version, encrypted.
  BagReader(const std::filesystem::path& file, std::string name);

  const std::vector<Topic>& topics() const override { return topics_; }
  TimeNs first_ns() const override { return chunks_.empty() ? 0 : chunks_.front().first_ns; }
  const std::string& warning() const override { return warning_; }
  void play(std::size_t topic) override;
  std::optional<Message> next() override;

 private:
  using Connection = std::uint32_t;
  struct Record {
    std::vector<char> header;
    BagFields fields;                    // views of the header, which stays in its place when it is moved
    std::uint64_t data = 0, length = 0;  // position of the data
    std::uint64_t end() const { return data + length; }
  };
  // A chunk, or a message outside of any.
  struct Chunk {
    TimeNs first_ns = 0;
    std::uint64_t offset = 0;  // position of the record
    std::set<Connection> connections;
  };
  struct Waiting {
    TimeNs t_ns = 0;
    std::uint64_t order = 0;
    std::shared_ptr<const std::string> octets;
    std::string_view message;  // in the octets
  };
  struct Later {
    bool operator()(const Waiting& a, const Waiting& b) const {
      return a.t_ns != b.t_ns ? a.t_ns > b.t_ns : a.order > b.order;
    }
  };

  [[noreturn]] void fail(const std::string& problem) const;
  std::string octets_of(std::uint64_t offset, std::uint64_t length);
  std::optional<Record> record_at(std::uint64_t offset);  // empty: the file ends before it does, or it is none

  bool read_index(const Record& bag_header);
  void scan(std::uint64_t at);
  void scan_record(const Record& record, std::uint64_t at);
  std::optional<Chunk> read_chunk_info(const Record& record);  // empty: it is none
  void add_connection(const BagFields& fields, std::string_view data);
  std::string records_of_chunk(const Record& record);
  template <class Visit>
  void for_each_record(std::string_view records, const Visit& visit) const;
  void load(const Chunk& chunk);

  const std::string name_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::string warning_;
  std::vector<Topic> topics_;
  std::vector<std::set<Connection>> connections_;  // connections of each topic
  std::vector<Chunk> chunks_;                      // ordered by first time

  std::size_t played_ = 0;
  std::size_t next_chunk_ = 0;
  std::uint64_t order_ = 0;
  std::priority_queue<Waiting, std::vector<Waiting>, Later> waiting_;
};

}  // namespace coslam::recording
