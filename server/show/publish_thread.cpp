// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish_thread.h"

#include <algorithm>
#include <utility>

#include "common/flow/give_way.h"

namespace coslam {

PublishThread::PublishThread(std::vector<PublicSink*> sinks)
    : sinks_(std::move(sinks)), worker_("publish", [this](const std::stop_token&) { run(); }) {}

PublishThread::~PublishThread() {
  slot_.close();
  worker_.join();
}

PartSet PublishThread::wanted() const {
  PartSet parts;
  for (const PublicSink* sink : sinks_) parts |= sink->parts();
  return parts;
}

void PublishThread::run() {
  give_way();
  const auto announce = [this](const ChannelPtr& channel) {
    for (PublicSink* sink : sinks_) sink->announce(channel);
  };
  const auto wants = [this](const Channel& channel) {
    return std::ranges::any_of(sinks_, [&](const PublicSink* sink) { return sink->wants(channel); });
  };
  const auto put = [this](const MessagePtr& message) {
    for (PublicSink* sink : sinks_) {
      if (sink->wants(*message->channel)) sink->put(message);
    }
  };
  std::ranges::for_each(publisher_.channels(), announce);
  while (const auto snapshot = slot_.take()) {
    for (PublicSink* sink : sinks_) sink->see(*snapshot);
    publisher_.encode(*snapshot, announce, wants, put);
  }
}

}  // namespace coslam
