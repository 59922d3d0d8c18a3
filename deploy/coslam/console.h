// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>

namespace coslam {

// Progress of long work on stderr: a bar in place on a terminal, a line every ten percent elsewhere.
class Progress {
 public:
  explicit Progress(std::string label);
  ~Progress();  // ends the bar's line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void operator()(int done, int total);

 private:
  void draw_bar(int percent);

  std::string label_;
  bool terminal_;
  bool bar_open_ = false;
  int shown_percent_ = -1;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// A bar of one thing after the other: mapping, then adjusting.
class ProgressOfRun {
 public:
  void mapping(int done, int total) { bar("mapping", done, total); }
  void adjusting(int percent) { bar("adjusting", percent, 100); }

 private:
  void bar(const char* label, int done, int total);

  std::string label_;
  std::unique_ptr<Progress> bar_;
};

}  // namespace coslam
