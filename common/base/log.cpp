// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/log.h"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace coslam {

namespace {

// A string of JSON, quotes included.
class Quoted final : public spdlog::custom_flag_formatter {
 public:
  enum class What { kText, kName };
  explicit Quoted(What part) : part_(part) {}
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
    const spdlog::string_view_t text = part_ == What::kText ? message.payload : message.logger_name;
    const std::string quoted = nlohmann::json(std::string(text.data(), text.size()))
                                   .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    out.append(quoted.data(), quoted.data() + quoted.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<Quoted>(part_); }

 private:
  What part_;
};

std::unique_ptr<spdlog::formatter> json_lines() {
  auto formatter = std::make_unique<spdlog::pattern_formatter>(spdlog::pattern_time_type::utc);
  formatter->add_flag<Quoted>('N', Quoted::What::kName).add_flag<Quoted>('V', Quoted::What::kText);
  formatter->set_pattern(R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l","program":%N,"text":%V})");
  return formatter;
}

std::atomic<int> pauses{0};

// A text without its figures; digits in a word, as in names, stay.
std::string without_figures(std::string_view text) {
  std::string out;
  bool in_word = false;
  for (const char c : text) {
    const bool digit = c >= '0' && c <= '9';
    in_word = std::isalpha(static_cast<unsigned char>(c)) != 0 || (digit && in_word);
    if (!digit || in_word) out += c;
  }
  return out;
}

class Given {
 public:
  void add(std::string_view text) {
    constexpr std::size_t kMost = 100;
    std::string key = without_figures(text);
    const std::lock_guard lock(mutex_);
    auto at = std::ranges::find(warnings_, key, &std::pair<std::string, Warning>::first);
    if (at == warnings_.end() && warnings_.size() == kMost) return;
    if (at == warnings_.end()) at = warnings_.emplace(at, std::move(key), Warning());
    at->second.text = text;
    ++at->second.count;
  }
  std::vector<Warning> all() const {
    const std::lock_guard lock(mutex_);
    std::vector<Warning> out;
    for (const auto& [key, warning] : warnings_) out.push_back(warning);
    return out;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::pair<std::string, Warning>> warnings_;  // by their text without figures
};

Given& given() {
  static Given instance;
  return instance;
}

}  // namespace

void init_log(std::string_view name, LogFormat format) {
  auto logger =
      std::make_shared<spdlog::logger>(std::string(name), std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  if (format == LogFormat::kJson) {
    logger->set_formatter(json_lines());
  } else {
    logger->set_pattern("%H:%M:%S.%e %n %l: %v");
  }
  logger->set_level(spdlog::level::info);
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(logger);
}

void log_info(std::string_view text) {
  if (pauses == 0) spdlog::info("{}", text);
}

void log_warn(std::string_view text) {
  if (pauses > 0) return;
  given().add(text);
  spdlog::warn("{}", text);
}
void log_error(std::string_view text) { spdlog::error("{}", text); }

std::vector<Warning> warnings_given() { return given().all(); }

LogPause::LogPause() { ++pauses; }
LogPause::~LogPause() { --pauses; }

bool LogLimiter::pass() {
  const auto now = std::chrono::steady_clock::now();
  if (last_ && now - *last_ < period_) return false;
  last_ = now;
  return true;
}

}  // namespace coslam
