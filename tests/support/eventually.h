// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>
#include <vector>

namespace coslam::test {

// Long enough for a machine under load; a test that is right never waits for it.
constexpr std::chrono::seconds kDeadline{20};

// Collects values from other threads; a test waits for a condition on all of them. Thread-safe.
template <class T>
class Collector {
 public:
  void add(T value) {
    {
      const std::lock_guard lock(mutex_);
      values_.push_back(std::move(value));
    }
    changed_.notify_all();
  }

  // True when `condition(values)` held before the deadline.
  template <class Condition>
  bool wait(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kDeadline, [&] { return condition(std::as_const(values_)); });
  }
  bool wait_count(std::size_t count) {
    return wait([count](const auto& values) { return values.size() >= count; });
  }

  std::vector<T> values() const {
    const std::lock_guard lock(mutex_);
    return values_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<T> values_;
};

}  // namespace coslam::test
