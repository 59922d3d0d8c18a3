// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "common/mcap/writer.h"
#include "server/show/publish/channel.h"

namespace coslam {

// Public messages into an MCAP file, all of them.
class McapSink final : public PublicSink {
 public:
  // out: takes the octets of the file, in order.
  explicit McapSink(mcap::Writer::Out out) : writer_(std::move(out), {.profile = "ros2"}) {}

  void announce(const ChannelPtr& channel) override;
  bool wants(const Channel&) const override { return true; }
  void put(const MessagePtr& message) override;
  PartSet parts() const override { return kAllParts; }

  void flush() { writer_.flush(); }  // makes all messages so far readable for a program that follows the file
  void close() { writer_.close(); }  // the end of the file

 private:
  mcap::Writer writer_;
  std::map<const Channel*, std::uint16_t> channels_;
};

}  // namespace coslam
