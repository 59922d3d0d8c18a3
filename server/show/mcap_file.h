// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>

#include "common/dataset/file.h"
#include "server/show/mcap_sink.h"

namespace coslam {

// Writes the public messages of a run into an MCAP file as they occur. A write error is logged once, and mapping goes
// on without the file.
class McapFile final : public PublicSink {
 public:
  // Throws UserError: it is there already, or cannot be made.
  explicit McapFile(const std::filesystem::path& file);
  McapFile(const McapFile&) = delete;
  McapFile& operator=(const McapFile&) = delete;
  ~McapFile() override;  // ends the file with its index

  void announce(const ChannelPtr& channel) override { sink_.announce(channel); }
  bool wants(const Channel&) const override { return true; }
  void put(const MessagePtr& message) override;
  PartSet parts() const override { return kAllParts; }

 private:
  void say_problem();

  OutputFile file_;
  McapSink sink_;
  std::chrono::steady_clock::time_point flushed_ = std::chrono::steady_clock::now();
};

}  // namespace coslam
