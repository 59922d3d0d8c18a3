// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/time.h"
#include "common/mcap/records.h"
#include "common/recording/bag_records.h"

// Small bags of ROS 1 for tests.
namespace coslam::recording::test {

inline std::string lz4_frame(std::string_view octets) {
  std::string out(LZ4F_compressFrameBound(octets.size(), nullptr), '\0');
  out.resize(LZ4F_compressFrame(out.data(), out.size(), octets.data(), octets.size(), nullptr));
  return out;
}

inline std::string bzip2(std::string octets) {
  auto size = static_cast<unsigned>(octets.size() + octets.size() / 50 + 1000);
  std::string out(size, '\0');
  BZ2_bzBuffToBuffCompress(out.data(), &size, octets.data(), static_cast<unsigned>(octets.size()), 1, 0, 0);
  out.resize(size);
  return out;
}

class BagFile {
 public:
  using Fields = std::vector<std::pair<std::string, std::string>>;

  // A chunk holds so many messages. Compression: "none", "bz2", "lz4".
  explicit BagFile(std::string compression = "none", std::size_t messages_per_chunk = 4)
      : compression_(std::move(compression)), per_chunk_(messages_per_chunk) {
    octets_ = std::string(kBagMagic) + bag_header(0, 0);
  }

  void add(const std::string& topic, const std::string& type, TimeNs t_ns, std::string_view message) {
    const auto [found, is_new] = connections_.emplace(topic, connections_.size());
    const auto connection = static_cast<std::uint32_t>(found->second);
    if (is_new) {
      descriptions_.push_back(record({{"op", "\x07"}, {"conn", number(connection)}, {"topic", topic}},
                                     header({{"topic", topic}, {"type", type}, {"md5sum", "*"}})));
      chunk_ += descriptions_.back();
    }
    chunk_ += record({{"op", "\x02"}, {"conn", number(connection)}, {"time", time(t_ns)}}, message);
    ++counts_[connection];
    first_ns_ = in_chunk_ == 0 ? t_ns : std::min(first_ns_, t_ns);
    last_ns_ = in_chunk_ == 0 ? t_ns : std::max(last_ns_, t_ns);
    if (++in_chunk_ == per_chunk_) end_chunk();
  }

  // As a recorder leaves it that was killed.
  std::string unclosed() {
    end_chunk();
    return octets_;
  }
  std::string closed() {
    end_chunk();
    const std::uint64_t index = octets_.size();
    for (const std::string& description : descriptions_) octets_ += description;
    for (const std::string& info : infos_) octets_ += info;
    const std::string head = bag_header(index, static_cast<std::uint32_t>(infos_.size()));
    return octets_.replace(kBagMagic.size(), head.size(), head);
  }

  template <class T>
  static std::string number(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
  }
  static std::string time(TimeNs t_ns) {
    constexpr TimeNs kSecond_ns = 1'000'000'000;
    return number(static_cast<std::uint32_t>(t_ns / kSecond_ns)) +
           number(static_cast<std::uint32_t>(t_ns % kSecond_ns));
  }
  static std::string header(const Fields& fields) {
    mcap::OctetWriter out;
    for (const auto& [name, value] : fields) out.put_text(name + "=" + value);
    return out.octets();
  }
  static std::string record(const Fields& fields, std::string_view data) {
    mcap::OctetWriter out;
    out.put_text(header(fields));
    out.put_text(data);
    return out.octets();
  }

 private:
  std::string bag_header(std::uint64_t index, std::uint32_t chunks) const {
    const auto connections = static_cast<std::uint32_t>(connections_.size());
    return record({{"op", "\x03"},
                   {"index_pos", number(index)},
                   {"conn_count", number(connections)},
                   {"chunk_count", number(chunks)}},
                  std::string(20, ' '));
  }

  void end_chunk() {
    if (in_chunk_ == 0) return;
    const std::string packed = compression_ == "lz4"   ? lz4_frame(chunk_)
                               : compression_ == "bz2" ? bzip2(chunk_)
                                                       : chunk_;
    std::string counts;
    for (const auto& [connection, count] : counts_) counts += number(connection) + number(count);
    const auto kinds = static_cast<std::uint32_t>(counts_.size());
    infos_.push_back(record({{"op", "\x06"},
                             {"ver", number(1U)},
                             {"chunk_pos", number(static_cast<std::uint64_t>(octets_.size()))},
                             {"start_time", time(first_ns_)},
                             {"end_time", time(last_ns_)},
                             {"count", number(kinds)}},
                            counts));
    const auto size = static_cast<std::uint32_t>(chunk_.size());
    octets_ += record({{"op", "\x05"}, {"compression", compression_}, {"size", number(size)}}, packed);
    chunk_.clear();
    counts_.clear();
    in_chunk_ = 0;
  }

  const std::string compression_;
  const std::size_t per_chunk_;
  std::string octets_, chunk_;
  std::map<std::string, std::size_t> connections_;
  std::vector<std::string> descriptions_, infos_;
  std::map<std::uint32_t, std::uint32_t> counts_;  // messages of each connection in the chunk
  std::size_t in_chunk_ = 0;
  TimeNs first_ns_ = 0, last_ns_ = 0;
};

}  // namespace coslam::recording::test
