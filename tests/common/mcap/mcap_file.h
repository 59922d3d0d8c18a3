// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "common/mcap/writer.h"

// Small MCAP files for tests.
namespace coslam::mcap::test {

inline std::string octets_in(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Three channels; message i is "i" in /even or /odd, at i ms. The third has none.
inline std::string counted_messages(int messages, const WriterConfig& config, bool close = true) {
  std::string octets;
  Writer writer([&](std::string_view more) { octets += more; }, config);
  const auto schema = writer.add_schema("std_msgs/msg/String", "ros2msg", "string data\n");
  const auto even = writer.add_channel("/even", "cdr", schema);
  const auto odd = writer.add_channel("/odd", "cdr", schema);
  writer.add_channel("/none", "json", 0);
  for (int i = 0; i < messages; ++i) {
    writer.write(i % 2 == 0 ? even : odd, TimeNs{i} * 1'000'000, std::string_view(std::to_string(i)));
  }
  if (close) {
    writer.close();
  } else {
    writer.flush();
  }
  return octets;
}

}  // namespace coslam::mcap::test
