// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/console.h"

#include <unistd.h>

#include <cstdio>
#include <memory>
#include <utility>

namespace coslam {

Progress::Progress(std::string label) : label_(std::move(label)), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (bar_open_) std::fputc('\n', stderr);
}

void Progress::operator()(int done, int total) {
  const int percent = total <= 0 ? 100 : static_cast<int>(100LL * done / total);
  const int step = terminal_ ? 1 : 10;
  if (percent / step == shown_percent_ / step && shown_percent_ >= 0) return;
  shown_percent_ = percent;
  if (terminal_) {
    draw_bar(percent);
  } else {
    std::fprintf(stderr, "%s: %d %% (%d of %d)\n", label_.c_str(), percent, done, total);
  }
}

void Progress::draw_bar(int percent) {
  constexpr int kWidth = 40;
  const int filled = percent * kWidth / 100;
  const std::string bar =
      std::string(static_cast<std::size_t>(filled), '#') + std::string(static_cast<std::size_t>(kWidth - filled), '.');
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  std::fprintf(stderr, "\r%s [%s] %3d %%", label_.c_str(), bar.c_str(), percent);
  if (percent > 0 && percent < 100) std::fprintf(stderr, " %4.0f s left", elapsed_s * (100 - percent) / percent);
  if (percent == 100) std::fprintf(stderr, " %4.0f s     ", elapsed_s);
  std::fflush(stderr);
  bar_open_ = true;
}

void ProgressOfRun::bar(const char* label, int done, int total) {
  if (label_ != label) {
    bar_.reset();  // ends its line
    bar_ = std::make_unique<Progress>(label);
    label_ = label;
  }
  (*bar_)(done, total);
}

}  // namespace coslam
