// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/frame.h>
#include <libswresample/swresample.h>
#include <libswscale/swscale.h>
}

#include <memory>

// FFmpeg's objects, each with the function that frees it.
namespace coslam::ffmpeg {

template <class T, void (*kFree)(T**)>
struct Freed {
  void operator()(T* object) const { kFree(&object); }
};
struct FreedScaler {
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};

using Container = std::unique_ptr<AVFormatContext, Freed<AVFormatContext, avformat_close_input>>;
using Codec = std::unique_ptr<AVCodecContext, Freed<AVCodecContext, avcodec_free_context>>;
using Packet = std::unique_ptr<AVPacket, Freed<AVPacket, av_packet_free>>;
using Frame = std::unique_ptr<AVFrame, Freed<AVFrame, av_frame_free>>;
using Resampler = std::unique_ptr<SwrContext, Freed<SwrContext, swr_free>>;
using Scaler = std::unique_ptr<SwsContext, FreedScaler>;

}  // namespace coslam::ffmpeg
