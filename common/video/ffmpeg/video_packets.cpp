// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/video/video_packets.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/pixdesc.h>
}

#include <cstring>
#include <string>
#include <utility>

#include "common/video/ffmpeg/decoded_damage.h"
#include "common/video/ffmpeg/plug_in.h"

namespace coslam {
namespace {

constexpr int kQuiet = 64;  // added to the level of each message of the decoder, which then is below all that are shown
constexpr std::int64_t kMostPixels = 1 << 26;
constexpr std::size_t kMostPacketOctets = 1U << 28U;

// Luma has a plane of its own, or is all there is.
Picture luma_of(const AVFrame& frame) {
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  constexpr std::uint64_t kOthers = AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM |
                                    AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_BE | AV_PIX_FMT_FLAG_FLOAT;
  if (format == nullptr || (format->flags & kOthers) != 0) return {};
  const AVComponentDescriptor& luma = format->comp[0];
  const int octets = luma.depth > 8 ? 2 : 1;
  if (luma.plane != 0 || luma.offset != 0 || luma.shift != 0 || luma.step != octets || frame.linesize[0] <= 0)
    return {};
  return {frame.width, frame.height, 1, octets, static_cast<std::size_t>(frame.linesize[0]), frame.data[0]};
}

class FfmpegPackets final : public VideoPackets {
 public:
  explicit FfmpegPackets(const AVCodec* codec)
      : decoder_(avcodec_alloc_context3(codec)),
        packet_(av_packet_alloc()),
        frame_(av_frame_alloc()),
        shown_(av_frame_alloc()) {}
  ~FfmpegPackets() override {
    avcodec_free_context(&decoder_);
    av_packet_free(&packet_);
    av_frame_free(&frame_);
    av_frame_free(&shown_);
  }
  FfmpegPackets(const FfmpegPackets&) = delete;
  FfmpegPackets& operator=(const FfmpegPackets&) = delete;

  bool open(const AVCodec* codec) {
    if (decoder_ == nullptr || packet_ == nullptr || frame_ == nullptr || shown_ == nullptr) return false;
    decoder_->flags |= AV_CODEC_FLAG_LOW_DELAY | AV_CODEC_FLAG_OUTPUT_CORRUPT;
    decoder_->thread_count = 1;  // several would hold frames back
    decoder_->log_level_offset = kQuiet;
    decoder_->max_pixels = kMostPixels;
    return avcodec_open2(decoder_, codec, nullptr) >= 0;
  }

  Picture decode(std::span<const std::uint8_t> packet) override {
    const std::int64_t number = sent_++;
    if (packet.empty() || packet.size() > kMostPacketOctets) return {};
    if (av_new_packet(packet_, static_cast<int>(packet.size())) < 0) return {};
    std::memcpy(packet_->data, packet.data(), packet.size());
    packet_->pts = packet_->dts = number;
    avcodec_send_packet(decoder_, packet_);  // what cannot be decoded gives no frame
    av_packet_unref(packet_);
    Picture luma;
    while (avcodec_receive_frame(decoder_, frame_) == 0) {
      constexpr int kHealsIn = 30;  // frames, without a key frame before
      const bool damaged = damage_.note(*frame_, false, kHealsIn);
      if (frame_->pts == number && !damaged) {
        std::swap(shown_, frame_);
        luma = luma_of(*shown_);
      }
      av_frame_unref(frame_);
    }
    return luma;
  }

 private:
  AVCodecContext* decoder_;
  AVPacket* packet_;
  AVFrame *frame_, *shown_;  // shown_: keeps the pixels of the newest picture
  std::int64_t sent_ = 0;
  DecodedDamage damage_;
};

}  // namespace

std::unique_ptr<VideoPackets> ffmpeg::packets_of(std::string_view codec) {
  const AVCodecDescriptor* descriptor = avcodec_descriptor_get_by_name(std::string(codec).c_str());
  const AVCodec* found = descriptor == nullptr ? nullptr : avcodec_find_decoder(descriptor->id);
  if (found == nullptr) return nullptr;
  auto packets = std::make_unique<FfmpegPackets>(found);
  if (!packets->open(found)) return nullptr;
  return packets;
}

}  // namespace coslam
