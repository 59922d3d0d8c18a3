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

struct Last {
  std::mutex mutex;
  std::string text = "unknown reason";
};

Last& last() {
  static Last instance;
  return instance;
}

class Consumer : public eprosima::fastdds::dds::LogConsumer {
 public:
  // Called on the thread of the middleware's log.
  void Consume(const Log::Entry& entry) override {
    if (entry.kind != Log::Kind::Error) return;
    {
      const std::lock_guard lock(last().mutex);
      last().text = entry.message;
    }
    if (limiter_.pass()) log_warn("DDS: " + entry.message);
  }

 private:
  LogLimiter limiter_;
};

}  // namespace

MiddlewareLog& MiddlewareLog::install() {
  static MiddlewareLog instance = [] {
    last();  // outlives the consumer
    Log::ClearConsumers();
    Log::RegisterConsumer(std::make_unique<Consumer>());
    return MiddlewareLog();
  }();
  return instance;
}

std::string MiddlewareLog::last_error() {
  Log::Flush();
  const std::lock_guard lock(last().mutex);
  return last().text;
}

}  // namespace coslam
