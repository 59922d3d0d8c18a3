// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

namespace coslam {

// Holds one value, which what comes before it is taken is merged into by T::update(T): bounded if T is. Any number of
// writers, one taker. Thread-safe.
template <class T>
class MergingSlot {
 public:
  MergingSlot() = default;
  ~MergingSlot() = default;
  MergingSlot(const MergingSlot&) = delete;
  MergingSlot& operator=(const MergingSlot&) = delete;

  void put(T value) {
    {
      const std::lock_guard lock(mutex_);
      if (closed_) return;
      if (value_) {
        value_->update(std::move(value));
      } else {
        value_ = std::move(value);
      }
    }
    filled_.notify_one();
  }

  // Waits for one; empty once closed and used up.
  std::optional<T> take() {
    std::unique_lock lock(mutex_);
    filled_.wait(lock, [this] { return closed_ || value_; });
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

 private:
  std::mutex mutex_;
  std::condition_variable filled_;
  std::optional<T> value_;
  bool closed_ = false;
};

}  // namespace coslam
