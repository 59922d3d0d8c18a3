// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace coslam {

// SIGINT and SIGTERM of a program that maps: they ask it to stop. What is here belongs to the process and may be called
// from any thread.
void catch_stop_signals();
const std::atomic<bool>& stop_requested();
// It was SIGTERM, as of a service manager, which has no patience.
bool stop_is_urgent();

// While one of these lives, a signal ends the process at once with this exit code: what it leaves is on the disk, and
// what it still does only betters it.
class EndsAtOnce {
 public:
  explicit EndsAtOnce(int exit_code);
  ~EndsAtOnce();
  EndsAtOnce(const EndsAtOnce&) = delete;
  EndsAtOnce& operator=(const EndsAtOnce&) = delete;
};

}  // namespace coslam
