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
// Warnings that this process has given, in the order of first occurrence. Warnings that differ only in their figures
// count as one, with the newest text.
std::vector<Warning> warnings_given();

// Suppresses info and warnings while an object of this class lives, because somebody else reports them.
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
