// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace coslam {

enum class LogFormat { kText, kJson };

// Sets the program's logger (stderr, one line an event). `name` stands in each line. JSON: an object a line with time
// (UTC), level, program and text.
void init_log(std::string_view name, LogFormat format = LogFormat::kText);
void log_info(std::string_view text);
void log_warn(std::string_view text);
void log_error(std::string_view text);

// A warning, and how often it was given.
struct Warning {
  std::string text;
  int count = 0;
};
// What this process has warned of, in the order of the first times. Those that differ in their figures alone are one:
// the newest stands for it.
std::vector<Warning> warnings_given();

// As long as one lives, info and warnings are not said: somebody else will say them.
class LogPause {
 public:
  LogPause();
  ~LogPause();
  LogPause(const LogPause&) = delete;
  LogPause& operator=(const LogPause&) = delete;
};

// Lets one event a second, or another period, through. Not for the pure core.
class LogLimiter {
 public:
  explicit LogLimiter(std::chrono::seconds period = std::chrono::seconds(1)) : period_(period) {}
  bool pass();

 private:
  const std::chrono::seconds period_;
  std::optional<std::chrono::steady_clock::time_point> last_;
};

}  // namespace coslam
