// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/stop_signals.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

namespace coslam {
namespace {

constexpr int kGoesOn = -1;

std::atomic<bool> requested{false}, urgent{false};
std::atomic<int> end_with{kGoesOn};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void on_signal(int signal) {
  if (signal == SIGTERM) urgent = true;
  requested = true;
  if (const int code = end_with; code != kGoesOn) _exit(code);
}

}  // namespace

void catch_stop_signals() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

const std::atomic<bool>& stop_requested() { return requested; }

bool stop_is_urgent() { return urgent; }

EndsAtOnce::EndsAtOnce(int exit_code) { end_with = exit_code; }
EndsAtOnce::~EndsAtOnce() { end_with = kGoesOn; }

}  // namespace coslam
