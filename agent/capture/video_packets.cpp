// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/video_packets.h"

#include "agent/capture/decoded_damage.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/pixdesc.h>
}

#include <array>
#include <cstring>
#include <utility>

namespace coslam {
namespace {

constexpr int kQuiet = 64;  // added to the level of each message of the decoder, which then is below all that are shown
constexpr std::int64_t kMostPixels = 1 << 26;
constexpr std::size_t kMostPacketOctets = 1U << 28U;

AVCodecID codec_id(std::string_view codec) {
  constexpr std::array<std::pair<std::string_view, AVCodecID>, 5> kCodecs{{{"264", AV_CODEC_ID_H264},
                                                                           {"265", AV_CODEC_ID_HEVC},
                                                                           {"hevc", AV_CODEC_ID_HEVC},
                                                                           {"vp9", AV_CODEC_ID_VP9},
                                                                           {"av1", AV_CODEC_ID_AV1}}};
  for (const auto& [name, id] : kCodecs) {
    if (codec.find(name) != std::string_view::npos) return id;
  }
  return AV_CODEC_ID_NONE;
}

// Luma has a plane of its own, or is all there is.
cv::Mat luma_of(const AVFrame& frame) {
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  constexpr std::uint64_t kOthers = AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM |
                                    AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_BE | AV_PIX_FMT_FLAG_FLOAT;
  if (format == nullptr || (format->flags & kOthers) != 0) return {};
  const AVComponentDescriptor& luma = format->comp[0];
  const int octets = luma.depth > 8 ? 2 : 1;
  if (luma.plane != 0 || luma.offset != 0 || luma.shift != 0 || luma.step != octets || frame.linesize[0] <= 0)
    return {};
  return cv::Mat(frame.height, frame.width, octets == 2 ? CV_16UC1 : CV_8UC1, frame.data[0],
                 static_cast<std::size_t>(frame.linesize[0]))
      .clone();
}

}  // namespace

struct VideoPackets::Impl {
  AVCodecContext* decoder = nullptr;
  AVPacket* packet = av_packet_alloc();
  AVFrame* frame = av_frame_alloc();
  std::int64_t sent = 0;
  DecodedDamage damage;
  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    avcodec_free_context(&decoder);
    av_packet_free(&packet);
    av_frame_free(&frame);
  }
};

VideoPackets::VideoPackets(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoPackets::~VideoPackets() = default;

std::unique_ptr<VideoPackets> VideoPackets::for_codec(std::string_view codec) {
  const AVCodecID id = codec_id(codec);
  const AVCodec* found = id == AV_CODEC_ID_NONE ? nullptr : avcodec_find_decoder(id);
  if (found == nullptr) return nullptr;
  auto impl = std::make_unique<Impl>();
  impl->decoder = avcodec_alloc_context3(found);
  if (impl->decoder == nullptr || impl->packet == nullptr || impl->frame == nullptr) return nullptr;
  impl->decoder->flags |= AV_CODEC_FLAG_LOW_DELAY | AV_CODEC_FLAG_OUTPUT_CORRUPT;
  impl->decoder->thread_count = 1;  // several would hold frames back
  impl->decoder->log_level_offset = kQuiet;
  impl->decoder->max_pixels = kMostPixels;
  if (avcodec_open2(impl->decoder, found, nullptr) < 0) return nullptr;
  return std::unique_ptr<VideoPackets>(new VideoPackets(std::move(impl)));
}

cv::Mat VideoPackets::decode(std::span<const std::uint8_t> packet) {
  const std::int64_t number = impl_->sent++;
  if (packet.empty() || packet.size() > kMostPacketOctets) return {};
  if (av_new_packet(impl_->packet, static_cast<int>(packet.size())) < 0) return {};
  std::memcpy(impl_->packet->data, packet.data(), packet.size());
  impl_->packet->pts = impl_->packet->dts = number;
  avcodec_send_packet(impl_->decoder, impl_->packet);  // what cannot be decoded gives no frame
  av_packet_unref(impl_->packet);
  cv::Mat luma;
  while (avcodec_receive_frame(impl_->decoder, impl_->frame) == 0) {
    constexpr int kHealsIn = 30;  // frames, without a key frame before
    const bool damaged = impl_->damage.note(*impl_->frame, false, kHealsIn);
    if (impl_->frame->pts == number && !damaged) luma = luma_of(*impl_->frame);
    av_frame_unref(impl_->frame);
  }
  return luma;
}

}  // namespace coslam
