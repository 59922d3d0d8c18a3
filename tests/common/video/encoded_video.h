// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
}

#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>
#include <string_view>
#include <vector>

namespace coslam::test {

// Grey frames as a live encoder sends them: a packet each, no B frames, every fifth a key frame. Empty: FFmpeg was
// built without that encoder.
inline std::vector<std::vector<std::uint8_t>> encoded_video(const std::vector<cv::Mat>& frames, const char* encoder) {
  const AVCodec* codec = avcodec_find_encoder_by_name(encoder);
  if (codec == nullptr) return {};
  AVCodecContext* context = avcodec_alloc_context3(codec);
  context->width = frames.front().cols;
  context->height = frames.front().rows;
  context->time_base = {1, 20};
  context->pix_fmt = AV_PIX_FMT_YUV420P;
  context->gop_size = 5;
  context->max_b_frames = 0;
  context->thread_count = 1;
  context->log_level_offset = 64;
  const bool is_x26 = std::string_view(encoder).starts_with("libx26");
  if (is_x26) av_opt_set(context->priv_data, "tune", "zerolatency", 0);
  av_opt_set(context->priv_data, "crf", "4", 0);
  av_opt_set(context->priv_data, "x265-params", "log-level=none", 0);
  av_opt_set(context->priv_data, "lag-in-frames", "0", 0);
  std::vector<std::vector<std::uint8_t>> packets;
  if (avcodec_open2(context, codec, nullptr) == 0) {
    AVPacket* packet = av_packet_alloc();
    AVFrame* frame = av_frame_alloc();
    frame->width = context->width;
    frame->height = context->height;
    frame->format = context->pix_fmt;
    av_frame_get_buffer(frame, 0);
    for (std::size_t i = 0; i <= frames.size(); ++i) {
      if (i < frames.size()) {
        av_frame_make_writable(frame);
        for (int y = 0; y < frame->height; ++y) {
          std::memcpy(frame->data[0] + y * frame->linesize[0], frames[i].ptr(y),
                      static_cast<std::size_t>(frame->width));
        }
        for (const int plane : {1, 2}) {
          std::memset(frame->data[plane], 128, static_cast<std::size_t>(frame->linesize[plane] * frame->height / 2));
        }
        frame->pts = static_cast<std::int64_t>(i);
      }
      avcodec_send_frame(context, i < frames.size() ? frame : nullptr);
      while (avcodec_receive_packet(context, packet) == 0) {
        packets.emplace_back(packet->data, packet->data + packet->size);
        av_packet_unref(packet);
      }
    }
    av_packet_free(&packet);
    av_frame_free(&frame);
  }
  avcodec_free_context(&context);
  return packets;
}

}  // namespace coslam::test
