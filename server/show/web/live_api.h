// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/flow/bounded_queue.h"
#include "common/flow/worker.h"
#include "common/model/thumbnail.h"
#include "server/show/publish/names.h"
#include "server/show/publish/rates.h"
#include "server/show/web/web_server.h"

namespace coslam {

// Answers requests to a running server from the newest snapshot: /metrics, /healthz, /readyz and /api/v1. One thread
// gives it snapshots, another asks. Thread-safe.
class LiveApi final : public PublicSink {
 public:
  LiveApi();

  void answer(const WebRequest& request, WebReply reply);
  // Figures of the web server for /metrics.
  void count(std::function<WebCounts()> counts);

  // Asks an agent for an image and returns the newest one. Empty function: the agents of this run give no images.
  using ThumbnailOf = std::function<std::optional<Thumbnail>(const std::string& agent)>;
  void look_by(ThumbnailOf thumbnail_of);

  void announce(const ChannelPtr&) override {}
  bool wants(const Channel&) const override { return false; }
  void put(const MessagePtr&) override {}
  PartSet parts() const override;  // the cloud, while somebody waits for it
  void see(const Snapshot& snapshot) override;

 private:
  using Clock = std::chrono::steady_clock;
  struct Waiting {
    WebReply reply;
    Clock::time_point received;
  };

  WebAnswer health() const;
  WebAnswer ready() const;
  WebAnswer metrics() const;
  WebAnswer thumbnail(const WebRequest& request) const;
  void map(WebReply reply);
  void explain(const WebRequest& request, const WebReply& reply);

  mutable std::mutex mutex_;
  std::function<WebCounts()> counts_;
  ThumbnailOf thumbnail_of_;
  std::shared_ptr<const PublicState> state_;
  Clock::time_point state_at_ = Clock::now();
  std::shared_ptr<const PublicCloud> cloud_;
  Clock::time_point cloud_at_{};
  std::vector<Waiting> waiting_;  // for the cloud
  std::atomic<bool> wants_cloud_{false};
  Rates rates_;
  RosNames names_;

  BoundedQueue<std::function<void()>> questions_;  // requests that take a while
  Worker worker_;
};

}  // namespace coslam
