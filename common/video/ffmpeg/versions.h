// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/frame.h>
}

#include <cstdint>

// What FFmpeg 5.1 and 6.1 say in different ways.
namespace coslam::ffmpeg {

#if LIBAVCODEC_VERSION_INT >= AV_VERSION_INT(60, 31, 100)

inline bool is_key(const AVFrame& frame) { return (frame.flags & AV_FRAME_FLAG_KEY) != 0; }

// The matrix by which a stream wants to be turned; null: there is none.
inline const std::uint8_t* display_matrix(const AVStream& stream) {
  const AVCodecParameters& codec = *stream.codecpar;
  const AVPacketSideData* found =
      av_packet_side_data_get(codec.coded_side_data, codec.nb_coded_side_data, AV_PKT_DATA_DISPLAYMATRIX);
  return found == nullptr ? nullptr : found->data;
}

#else

inline bool is_key(const AVFrame& frame) { return frame.key_frame != 0; }

inline const std::uint8_t* display_matrix(const AVStream& stream) {
  return av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
}

#endif

}  // namespace coslam::ffmpeg
