// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

extern "C" {
#include <libavutil/log.h>
}

namespace coslam {

// Silences FFmpeg while an object of this class lives: a file is only asked whether it is a video.
class QuietFfmpeg {
 public:
  QuietFfmpeg() : level_(av_log_get_level()) { av_log_set_level(AV_LOG_QUIET); }
  ~QuietFfmpeg() { av_log_set_level(level_); }
  QuietFfmpeg(const QuietFfmpeg&) = delete;
  QuietFfmpeg& operator=(const QuietFfmpeg&) = delete;

 private:
  int level_;
};

}  // namespace coslam
