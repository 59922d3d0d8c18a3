// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace coslam {

// Handling of SIGINT and SIGTERM, which ask a program that maps to stop. All of it belongs to the process and may be
// called from any thread.
void catch_stop_signals();
const std::atomic<bool>& stop_requested();
// True after SIGTERM, as of a service manager, which does not wait long.
bool stop_is_urgent();

// Makes a signal end the process at once with this exit code while an object lives: the result is on the disk already,
// and further work only improves it.
class EndsAtOnce {
 public:
  explicit EndsAtOnce(int exit_code);
  ~EndsAtOnce();
  EndsAtOnce(const EndsAtOnce&) = delete;
  EndsAtOnce& operator=(const EndsAtOnce&) = delete;
};

}  // namespace coslam
