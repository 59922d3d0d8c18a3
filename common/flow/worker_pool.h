// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <list>
#include <mutex>
#include <string>

#include "common/base/workers.h"
#include "common/flow/worker.h"

namespace coslam {

// Threads that share in the parts of one caller's work, beside its own. each() is for one thread at a time.
class WorkerPool final : public Workers {
 public:
  // threads: with the caller's; 1: nobody but it.
  WorkerPool(const std::string& name, int threads);
  ~WorkerPool() override;
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  std::size_t at_once() const override { return helpers_.size() + 1; }
  void each(std::size_t n, const Part& part) override;

 private:
  void help(const std::stop_token& stop);
  void do_parts(const Part& part);

  std::mutex mutex_;
  std::condition_variable_any work_there_;
  std::condition_variable done_;
  const Part* part_ = nullptr;  // null: nothing to do
  std::uint64_t call_ = 0;
  std::size_t n_ = 0;
  std::atomic<std::size_t> next_{0};
  int busy_ = 0;  // helpers
  std::exception_ptr failure_;
  std::list<Worker> helpers_;  // last: they end first
};

}  // namespace coslam
