// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/flow/worker_pool.h"

#include <utility>

namespace coslam {

WorkerPool::WorkerPool(const std::string& name, int threads) {
  for (int i = 1; i < threads; ++i) helpers_.emplace_back(name, [this](const std::stop_token& stop) { help(stop); });
}

WorkerPool::~WorkerPool() = default;

void WorkerPool::each(std::size_t n, const Part& part) {
  if (n < 2 || helpers_.empty()) {
    Workers::each(n, part);
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    part_ = &part;
    n_ = n;
    next_ = 0;
    ++call_;
  }
  work_there_.notify_all();
  do_parts(part);
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return busy_ == 0; });
  part_ = nullptr;  // who wakes only now has nothing to do
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void WorkerPool::do_parts(const Part& part) {
  for (std::size_t i = next_++; i < n_; i = next_++) {
    try {
      part(i);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
  }
}

void WorkerPool::help(const std::stop_token& stop) {
  std::uint64_t seen = 0;
  std::unique_lock lock(mutex_);
  while (work_there_.wait(lock, stop, [&] { return part_ != nullptr && call_ != seen; })) {
    seen = call_;
    const Part* part = part_;
    ++busy_;
    lock.unlock();
    do_parts(*part);
    lock.lock();
    if (--busy_ == 0) done_.notify_one();
  }
}

}  // namespace coslam
