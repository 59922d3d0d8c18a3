// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace coslam {

// Durations of one stage in constant memory: a logarithmic histogram, 4 % wide bins from 1 us to 100 s; beyond, the
// longest.
class DurationHistogram {
 public:
  void add_ms(double ms);
  double percentile_ms(double percent) const;  // 0 when empty; exact to the bin width
  double mean_ms() const { return count_ == 0 ? 0.0 : sum_ms_ / static_cast<double>(count_); }
  double max_ms() const { return max_ms_; }
  std::uint64_t count() const { return count_; }

 private:
  static constexpr std::size_t kBins = 472;
  std::array<std::uint32_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  double sum_ms_ = 0.0;
  double max_ms_ = 0.0;
};

// Wall time per named stage. Thread-compatible: one owner.
class StageTimes {
 public:
  // Times a scope: `auto t = times.measure("track");`
  class Scope {
   public:
    explicit Scope(DurationHistogram& h) : histogram_(h), start_(std::chrono::steady_clock::now()) {}
    ~Scope() {
      const auto elapsed = std::chrono::steady_clock::now() - start_;
      histogram_.add_ms(std::chrono::duration<double, std::milli>(elapsed).count());
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    DurationHistogram& histogram_;
    std::chrono::steady_clock::time_point start_;
  };

  Scope measure(const std::string& stage) { return Scope(stages_[stage]); }
  // A time measured elsewhere, for a stage that only counts when it had something to do.
  void add(const std::string& stage, std::chrono::steady_clock::duration elapsed) {
    stages_[stage].add_ms(std::chrono::duration<double, std::milli>(elapsed).count());
  }
  const std::map<std::string, DurationHistogram>& stages() const { return stages_; }

 private:
  std::map<std::string, DurationHistogram> stages_;
};

// Peak resident memory of this process, MiB.
double peak_memory_mib();

}  // namespace coslam
