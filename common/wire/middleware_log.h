// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace coslam {

// Brings the middleware's error messages into our log, at most one a second. Thread-safe, one a process since the
// middleware's log is.
class MiddlewareLog {
 public:
  static MiddlewareLog& install();
  std::string last_error();  // what the middleware complained about last, or a plain "unknown reason"
};

}  // namespace coslam
