// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <cstring>
#include <vector>

#include "common/video/ffmpeg/owned.h"
#include "common/video/ffmpeg/plug_in.h"
#include "common/video/ffmpeg/quiet_ffmpeg.h"

namespace coslam {
namespace {

ffmpeg::Frame decoded(std::span<const std::uint8_t> octets, const char* name) {
  const AVCodec* codec = avcodec_find_decoder_by_name(name);
  ffmpeg::Codec decoder(codec == nullptr ? nullptr : avcodec_alloc_context3(codec));
  const ffmpeg::Packet packet(av_packet_alloc());
  ffmpeg::Frame frame(av_frame_alloc());
  if (!decoder || !packet || !frame) return nullptr;
  decoder->thread_count = 1;
  if (avcodec_open2(decoder.get(), codec, nullptr) < 0) return nullptr;
  if (av_new_packet(packet.get(), static_cast<int>(octets.size())) < 0) return nullptr;
  std::memcpy(packet->data, octets.data(), octets.size());
  if (avcodec_send_packet(decoder.get(), packet.get()) < 0) return nullptr;
  avcodec_send_packet(decoder.get(), nullptr);
  if (avcodec_receive_frame(decoder.get(), frame.get()) < 0) return nullptr;
  return frame;
}

// The form closest to that of the frame of those that a picture may have.
AVPixelFormat plain_form(const AVFrame& frame) {
  const AVPixFmtDescriptor* form = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  if (form == nullptr) return AV_PIX_FMT_NONE;
  const bool deep = form->comp[0].depth > 8;
  const bool grey = form->nb_components <= 2 && (form->flags & AV_PIX_FMT_FLAG_PAL) == 0;
  if (grey) return deep ? AV_PIX_FMT_GRAY16 : AV_PIX_FMT_GRAY8;
  return deep ? AV_PIX_FMT_BGR48 : AV_PIX_FMT_BGR24;
}

}  // namespace

bool ffmpeg::decode_image(std::span<const std::uint8_t> octets, const ImageForm& form,
                          const std::function<void(const Picture&)>& visit) {
  constexpr std::size_t kMostOctets = 1U << 30U;
  if (octets.size() > kMostOctets) return false;
  const QuietFfmpeg quiet;
  const ffmpeg::Frame frame = decoded(octets, form.decoder);
  if (!frame || frame->width <= 0 || frame->height <= 0) return false;
  const AVPixelFormat plain = plain_form(*frame);
  if (plain == AV_PIX_FMT_NONE) return false;
  const bool deep = plain == AV_PIX_FMT_GRAY16 || plain == AV_PIX_FMT_BGR48;
  const int channels = plain == AV_PIX_FMT_GRAY16 || plain == AV_PIX_FMT_GRAY8 ? 1 : 3;
  const ffmpeg::Scaler scaler(sws_getContext(frame->width, frame->height, static_cast<AVPixelFormat>(frame->format),
                                             frame->width, frame->height, plain, SWS_BICUBIC | SWS_ACCURATE_RND,
                                             nullptr, nullptr, nullptr));
  if (!scaler) return false;
  constexpr int kSlack = 64;  // pixels; the scaler writes past the end of a row
  const int row = channels * (deep ? 2 : 1) * (frame->width + kSlack);
  std::vector<std::uint8_t> rows(static_cast<std::size_t>(row) * static_cast<std::size_t>(frame->height));
  std::uint8_t* const planes[4] = {rows.data(), nullptr, nullptr, nullptr};
  const int steps[4] = {row, 0, 0, 0};
  if (sws_scale(scaler.get(), frame->data, frame->linesize, 0, frame->height, planes, steps) != frame->height)
    return false;
  visit({frame->width, frame->height, channels, deep ? 2 : 1, static_cast<std::size_t>(row), rows.data()});
  return true;
}

}  // namespace coslam
