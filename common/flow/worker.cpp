// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/flow/worker.h"

#include <pthread.h>

#include <cstdlib>
#include <exception>
#include <utility>

#include "common/base/log.h"

namespace coslam {
namespace {

void run(std::stop_token stop, const std::string& name, const std::function<void(std::stop_token)>& body) {
  // The kernel's limit is 15 characters; a longer name would be refused as a whole.
  pthread_setname_np(pthread_self(), name.substr(0, 15).c_str());
  try {
    body(std::move(stop));
  } catch (const std::exception& e) {
    log_error("thread '" + name + "' failed: " + e.what());
    std::abort();
  }
}

}  // namespace

Worker::Worker(std::string name, std::function<void(std::stop_token)> body)
    : thread_([name = std::move(name), body = std::move(body)](std::stop_token stop) {
        run(std::move(stop), name, body);
      }) {}

void Worker::join() {
  if (thread_.joinable()) thread_.join();
}

}  // namespace coslam
