// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace coslam {

// Brings the middleware's error messages into our log, at most one a second. Thread-safe; for the whole process, since
// the middleware's log is. Does nothing when it was called before.
void capture_middleware_log();

// The errors of one call of the middleware, kept from the log: it returns none, and its first complaint is the one that
// says why. One at a time.
class ErrorWatch {
 public:
  ErrorWatch();
  ~ErrorWatch();
  ErrorWatch(const ErrorWatch&) = delete;
  ErrorWatch& operator=(const ErrorWatch&) = delete;

  std::string first();  // without the place in the middleware's source; "unknown reason" when there was none
};

}  // namespace coslam
