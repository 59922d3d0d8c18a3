// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

namespace coslam {

// Holds the newest value only: a value that was not taken before the next one came is overwritten and counted.
// Any number of writers, one taker. Thread-safe.
template <class T>
class LatestSlot {
 public:
  LatestSlot() = default;
  ~LatestSlot() = default;
  LatestSlot(const LatestSlot&) = delete;
  LatestSlot& operator=(const LatestSlot&) = delete;

  void put(T value) {
    {
      const std::lock_guard lock(mutex_);
      if (closed_) return;
      if (value_) ++overwritten_;
      value_ = std::move(value);
    }
    filled_.notify_one();
  }

  // The newest value if one came since the last take.
  std::optional<T> try_take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(value_, std::nullopt);
  }

  // Waits for one; empty once closed and used up.
  std::optional<T> take() {
    std::unique_lock lock(mutex_);
    filled_.wait(lock, [this] { return closed_ || value_; });
    return std::exchange(value_, std::nullopt);
  }

  // Like take(), but gives up after the timeout.
  template <class Rep, class Period>
  std::optional<T> take_for(std::chrono::duration<Rep, Period> timeout) {
    std::unique_lock lock(mutex_);
    filled_.wait_for(lock, timeout, [this] { return closed_ || value_; });
    return std::exchange(value_, std::nullopt);
  }

  // Wakes the taker; later values are ignored.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    filled_.notify_all();
  }

  std::uint64_t overwritten() const {
    const std::lock_guard lock(mutex_);
    return overwritten_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable filled_;
  std::optional<T> value_;
  std::uint64_t overwritten_ = 0;
  bool closed_ = false;
};

}  // namespace coslam
