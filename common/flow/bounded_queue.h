// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>

#include "common/base/check.h"

namespace coslam {

// Reaction of push() to a full queue.
enum class QueuePolicy : std::uint8_t {
  kDropOldest,  // makes room; the newest matters
  kBlock,       // waits for room; nothing may be lost
  kRefuse,      // returns false; the caller decides
};

struct QueueCounts {
  std::size_t depth = 0;      // waiting now
  std::size_t peak = 0;       // maximum of depth so far
  std::uint64_t dropped = 0;  // items lost with kDropOldest
  std::uint64_t refused = 0;  // items refused: with kRefuse, when nothing could be dropped, or after close()
};

// Queue between any number of threads, first in, first out. Thread-safe.
template <class T>
class BoundedQueue {
 public:
  using Droppable = std::function<bool(const T&)>;

  // `droppable` limits what kDropOldest may drop; when nothing in a full queue is, push() refuses.
  BoundedQueue(std::size_t capacity, QueuePolicy policy, Droppable droppable = {})
      : capacity_(capacity), policy_(policy), droppable_(std::move(droppable)) {
    COSLAM_CHECK(capacity > 0, "a queue needs room for one item");
  }
  BoundedQueue(const BoundedQueue&) = delete;
  BoundedQueue& operator=(const BoundedQueue&) = delete;
  ~BoundedQueue() = default;

  // Adds an item; false when it was not taken: refused, or the queue is closed (also while waiting).
  bool push(T item) {
    {
      std::unique_lock lock(mutex_);
      if (!make_room(lock)) {
        ++counts_.refused;
        return false;
      }
      items_.push_back(std::move(item));
      counts_.peak = std::max(counts_.peak, items_.size());
    }
    filled_.notify_one();
    return true;
  }

  // Waits for an item; empty once the queue is closed and used up.
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    filled_.wait(lock, [this] { return closed_ || !items_.empty(); });
    return take(lock);
  }

  // Like pop(), but gives up after the timeout.
  template <class Rep, class Period>
  std::optional<T> pop_for(std::chrono::duration<Rep, Period> timeout) {
    std::unique_lock lock(mutex_);
    filled_.wait_for(lock, timeout, [this] { return closed_ || !items_.empty(); });
    return take(lock);
  }

  std::optional<T> try_pop() {
    std::unique_lock lock(mutex_);
    return take(lock);
  }

  // Wakes everybody: no more is taken in, what is inside can still be popped.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    filled_.notify_all();
    emptied_.notify_all();
  }

  bool closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
  }

  QueueCounts counts() const {
    const std::lock_guard lock(mutex_);
    QueueCounts counts = counts_;
    counts.depth = items_.size();
    return counts;
  }

 private:
  bool make_room(std::unique_lock<std::mutex>& lock) {
    if (policy_ == QueuePolicy::kBlock) {
      emptied_.wait(lock, [this] { return closed_ || items_.size() < capacity_; });
    }
    if (closed_) return false;
    return items_.size() < capacity_ || (policy_ == QueuePolicy::kDropOldest && drop_one());
  }

  bool drop_one() {
    const auto oldest = droppable_ ? std::find_if(items_.begin(), items_.end(), droppable_) : items_.begin();
    if (oldest == items_.end()) return false;
    items_.erase(oldest);
    ++counts_.dropped;
    return true;
  }

  std::optional<T> take(std::unique_lock<std::mutex>& lock) {
    if (items_.empty()) return std::nullopt;
    std::optional<T> item(std::move(items_.front()));
    items_.pop_front();
    lock.unlock();
    emptied_.notify_one();
    return item;
  }

  const std::size_t capacity_;
  const QueuePolicy policy_;
  const Droppable droppable_;
  mutable std::mutex mutex_;
  std::condition_variable filled_, emptied_;
  std::deque<T> items_;
  QueueCounts counts_;
  bool closed_ = false;
};

}  // namespace coslam
