// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <thread>

namespace coslam {

// One named thread. It runs `body` once; the destructor asks it to stop and joins. The body must return soon after the
// token says so: what it waits on (a queue, a slot) is closed by its owner, or by a std::stop_callback.
// An exception that leaves the body is a bug: it is logged and ends the process.
class Worker {
 public:
  Worker(std::string name, std::function<void(std::stop_token)> body);
  ~Worker() = default;
  Worker(Worker&&) = default;
  Worker& operator=(Worker&&) = delete;
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void request_stop() { thread_.request_stop(); }
  void join();  // waits for the body to return; may be called twice

 private:
  std::jthread thread_;
};

}  // namespace coslam
