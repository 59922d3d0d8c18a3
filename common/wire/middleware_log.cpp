// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/middleware_log.h"

#include <fastdds/dds/log/Log.hpp>
#include <memory>
#include <mutex>

#include "common/base/log.h"

namespace coslam {
namespace {

using eprosima::fastdds::dds::Log;

struct Watched {
  std::mutex mutex;
  bool on = false;
  std::string first;
};

Watched& watched() {
  static Watched instance;
  return instance;
}

class Consumer : public eprosima::fastdds::dds::LogConsumer {
 public:
  // Called on the thread of the middleware's log.
  void Consume(const Log::Entry& entry) override {
    if (entry.kind != Log::Kind::Error || entry.message.empty()) return;
    {
      const std::lock_guard lock(watched().mutex);
      if (watched().first.empty()) watched().first = entry.message;
      if (watched().on) return;
    }
    if (limiter_.pass()) log_warn("DDS: " + entry.message);
  }

 private:
  LogLimiter limiter_;
};

}  // namespace

void capture_middleware_log() {
  static const bool done = [] {
    watched();  // outlives the consumer
    Log::ClearConsumers();
    Log::RegisterConsumer(std::make_unique<Consumer>());
    return true;
  }();
  (void)done;
}

ErrorWatch::ErrorWatch() {
  const std::lock_guard lock(watched().mutex);
  watched().on = true;
  watched().first.clear();
}

ErrorWatch::~ErrorWatch() {
  const std::lock_guard lock(watched().mutex);
  watched().on = false;
}

std::string ErrorWatch::first() {
  Log::Flush();
  const std::lock_guard lock(watched().mutex);
  const std::string text = watched().first.substr(0, watched().first.find(" (./"));
  return text.empty() ? "unknown reason" : text;
}

}  // namespace coslam
