// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/flow/merging_slot.h"
#include "common/flow/worker.h"
#include "server/show/publish/publisher.h"

namespace coslam {

// Makes messages of snapshots in a thread of its own and gives them to the sinks.
class PublishThread {
 public:
  // The sinks outlive it.
  explicit PublishThread(std::vector<PublicSink*> sinks);
  ~PublishThread();  // publishes what was put before
  PublishThread(const PublishThread&) = delete;
  PublishThread& operator=(const PublishThread&) = delete;

  // Parts that some sink wants now.
  PartSet wanted() const;
  // Queues a snapshot and never waits: a snapshot that was not encoded in time is replaced by a newer one.
  void put(Snapshot snapshot) { slot_.put(std::move(snapshot)); }

 private:
  void run();

  const std::vector<PublicSink*> sinks_;
  MergingSlot<Snapshot> slot_;
  Publisher publisher_;
  Worker worker_;  // last: stops first
};

}  // namespace coslam
