// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/feed.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "agent/capture/image_check.h"
#include "common/flow/bounded_queue.h"
#include "common/flow/clock.h"
#include "common/flow/worker.h"

namespace coslam {
namespace {

constexpr std::size_t kReadAhead = 3;
constexpr std::size_t kRealTimeQueue = 8;  // a quarter of a second: one slow step costs no image

void look_at(ImageCheck& check, Image* image) {
  image->fault = check.check(*image);
  image->pattern_stays = check.pattern_stays();
}

class DirectFeed final : public Feed {
 public:
  explicit DirectFeed(std::unique_ptr<ImageSource> source) : source_(std::move(source)) {}
  std::optional<Image> next(const std::atomic<bool>&) override {
    auto image = source_->next();
    if (image) look_at(check_, &*image);
    return image;
  }
  std::uint32_t dropped() const override { return 0; }

 private:
  std::unique_ptr<ImageSource> source_;
  ImageCheck check_;
};

// When a live source should have given its next image.
class Due {
 public:
  void came(std::chrono::steady_clock::time_point now) {
    if (last_) intervals_s_[count_++ % intervals_s_.size()] = std::chrono::duration<double>(now - *last_).count();
    last_ = reported_ = now;
  }
  // None came for longer than usual, and that was not said just now.
  bool is_over(std::chrono::steady_clock::time_point now) {
    const double patience_s = std::max(kLeast_s, kUsual * *std::ranges::max_element(intervals_s_));
    if (!last_ || std::chrono::duration<double>(now - reported_).count() < patience_s) return false;
    reported_ = now;
    return true;
  }

 private:
  static constexpr double kLeast_s = 0.2, kUsual = 2.5;
  std::optional<std::chrono::steady_clock::time_point> last_;
  std::chrono::steady_clock::time_point reported_;
  std::array<double, 8> intervals_s_{};  // the newest ones
  std::size_t count_ = 0;
};

class ThreadedFeed final : public Feed {
 public:
  // rate 0: no clock, nothing dropped. Goes by the time of day at the start only: that may be set.
  ThreadedFeed(std::unique_ptr<ImageSource> source, double rate, TimeNs start_utc_ns)
      : source_(std::move(source)),
        rate_(rate),
        start_(Clock::now() + std::chrono::nanoseconds(start_utc_ns - utc_now_ns())),
        live_(rate > 0 && source_->live()),
        queue_(rate > 0 ? kRealTimeQueue : kReadAhead, rate > 0 ? QueuePolicy::kDropOldest : QueuePolicy::kBlock),
        worker_("capture", [this](const std::stop_token& stop) { read(stop); }) {}
  ~ThreadedFeed() override {
    worker_.request_stop();
    source_->stop();
    queue_.close();
  }
  ThreadedFeed(const ThreadedFeed&) = delete;
  ThreadedFeed& operator=(const ThreadedFeed&) = delete;

  std::optional<Image> next(const std::atomic<bool>& stop) override {
    while (!stop) {
      auto image = queue_.pop_for(std::chrono::milliseconds(live_ ? 50 : 100));
      if (image && live_ && image->fault != ImageFault::kMissing) due_.came(Clock::now());
      if (image) return image;
      if (queue_.closed()) return queue_.try_pop();
      if (live_ && due_.is_over(Clock::now())) return missing();
    }
    return std::nullopt;
  }
  std::uint32_t dropped() const override { return skipped_ + static_cast<std::uint32_t>(queue_.counts().dropped); }

 private:
  using Clock = std::chrono::steady_clock;

  static Image missing() {
    Image none{FrameId(), utc_now_ns(), {}};
    none.fault = ImageFault::kMissing;
    return none;
  }

  void read(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      if (rate_ > 0 && !source_->live() && !wait_until_due(stop)) break;
      std::optional<Image> image = source_->next();
      if (!image) break;
      look_at(check_, &*image);
      if (rate_ > 0) image->available_since = std::chrono::steady_clock::now();
      if (!queue_.push(std::move(*image))) break;
    }
    queue_.close();
  }

  // Sleeps until the next image is due; passes over images that are late by more than the queue could hide.
  bool wait_until_due(const std::stop_token& stop) {
    for (;;) {
      const std::optional<TimeNs> t_ns = source_->peek_ns();
      if (!t_ns) return true;  // the end, told by next()
      const Clock::time_point due =
          start_ + std::chrono::nanoseconds(static_cast<TimeNs>(static_cast<double>(*t_ns) / rate_));
      if (Clock::now() - due > std::chrono::milliseconds(200)) {
        if (!source_->skip()) return true;
        ++skipped_;
        continue;
      }
      std::mutex mutex;
      std::unique_lock lock(mutex);
      sleep_.wait_until(lock, stop, due, [] { return false; });
      return !stop.stop_requested();
    }
  }

  std::unique_ptr<ImageSource> source_;
  double rate_;
  Clock::time_point start_;  // of played time
  ImageCheck check_;         // the worker's
  const bool live_;
  Due due_;  // the taker's
  std::atomic<std::uint32_t> skipped_{0};
  std::condition_variable_any sleep_;
  BoundedQueue<Image> queue_;
  Worker worker_;  // last: joins before what it uses goes
};

}  // namespace

std::unique_ptr<Feed> direct_feed(std::unique_ptr<ImageSource> source) {
  return std::make_unique<DirectFeed>(std::move(source));
}

std::unique_ptr<Feed> prefetching_feed(std::unique_ptr<ImageSource> source) {
  return std::make_unique<ThreadedFeed>(std::move(source), 0.0, 0);
}

std::unique_ptr<Feed> real_time_feed(std::unique_ptr<ImageSource> source, double rate, TimeNs start_utc_ns) {
  return std::make_unique<ThreadedFeed>(std::move(source), rate, start_utc_ns);
}

}  // namespace coslam
