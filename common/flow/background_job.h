// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "common/base/check.h"
#include "common/flow/give_way.h"
#include "common/flow/latest_slot.h"
#include "common/flow/worker.h"

namespace coslam {

// Runs one job at a time in a thread beside the caller's, which gives way to it. To be used by one thread.
template <class Result>
class BackgroundJob {
 public:
  explicit BackgroundJob(std::string name)
      : worker_(std::move(name), [this](const std::stop_token& stop) {
          give_way();
          while (!stop.stop_requested()) {
            std::optional<std::function<Result()>> job = jobs_.take();
            if (!job) return;
            results_.put((*job)());
          }
        }) {}
  // Waits for the job in work; its result is lost.
  ~BackgroundJob() {
    jobs_.close();
    results_.close();
  }
  BackgroundJob(const BackgroundJob&) = delete;
  BackgroundJob& operator=(const BackgroundJob&) = delete;

  // Whether a job is under way: from start() until its result is taken.
  bool busy() const { return busy_; }
  // Starts a job; must not be called while busy().
  void start(std::function<Result()> job) {
    COSLAM_CHECK(!busy_, "one job at a time");
    busy_ = true;
    jobs_.put(std::move(job));
  }
  // The result, if it is there; wait: as soon as it is. Empty when nothing was started.
  std::optional<Result> take(bool wait = false) {
    if (!busy_) return std::nullopt;
    std::optional<Result> result = wait ? results_.take() : results_.try_take();
    busy_ = !result.has_value();
    return result;
  }

 private:
  LatestSlot<std::function<Result()>> jobs_;
  LatestSlot<Result> results_;
  bool busy_ = false;
  Worker worker_;  // last: joins before what it uses goes
};

}  // namespace coslam
