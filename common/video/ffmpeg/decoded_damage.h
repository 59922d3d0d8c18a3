// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

extern "C" {
#include <libavutil/frame.h>
}

#include "common/video/ffmpeg/versions.h"

namespace coslam {

// Tells which frames of a video are made up, from the errors of FFmpeg's decoders: what is made from a damaged frame is
// damaged too, until a key frame, or until most of it has come anew.
class DecodedDamage {
 public:
  // The next frame. cut: its packet was damaged. heals_in: frames, this one included, that damage lasts. True: it is
  // made up.
  bool note(const AVFrame& frame, bool cut, int heals_in) {
    if (cut || frame.decode_error_flags != 0 || (frame.flags & AV_FRAME_FLAG_CORRUPT) != 0) {
      left_ = heals_in;
    } else if (left_ > 0) {
      left_ = ffmpeg::is_key(frame) ? 0 : left_ - 1;
    }
    return left_ > 0;
  }

 private:
  int left_ = 0;
};

}  // namespace coslam
