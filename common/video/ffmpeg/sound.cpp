// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/channel_layout.h>
#include <libswresample/swresample.h>
}

#include <algorithm>
#include <memory>
#include <utility>

#include "common/video/ffmpeg/owned.h"
#include "common/video/ffmpeg/plug_in.h"
#include "common/video/ffmpeg/quiet_ffmpeg.h"

namespace coslam {
namespace {

constexpr double kMost_s = 600;

class SoundReader {
 public:
  explicit SoundReader(const std::filesystem::path& video) {
    AVFormatContext* opened = nullptr;
    if (avformat_open_input(&opened, video.c_str(), nullptr, nullptr) != 0) return;
    container_.reset(opened);
    if (avformat_find_stream_info(opened, nullptr) < 0) return;
    const AVCodec* codec = nullptr;
    stream_ = av_find_best_stream(opened, AVMEDIA_TYPE_AUDIO, -1, -1, &codec, 0);
    if (stream_ < 0 || codec == nullptr) return;
    decoder_.reset(avcodec_alloc_context3(codec));
    if (avcodec_parameters_to_context(decoder_.get(), opened->streams[stream_]->codecpar) < 0 ||
        avcodec_open2(decoder_.get(), codec, nullptr) < 0) {
      decoder_.reset();
    }
  }

  std::optional<Sound> read() {
    if (!decoder_) return std::nullopt;
    const ffmpeg::Packet packet(av_packet_alloc());
    const auto most = static_cast<std::size_t>(kMost_s * Sound::kRate_hz);
    while (sound_.samples.size() < most && av_read_frame(container_.get(), packet.get()) >= 0) {
      if (packet->stream_index == stream_ && avcodec_send_packet(decoder_.get(), packet.get()) >= 0) take_frames();
      av_packet_unref(packet.get());
    }
    avcodec_send_packet(decoder_.get(), nullptr);
    take_frames();
    return begun_ && !sound_.samples.empty() ? std::optional(std::move(sound_)) : std::nullopt;
  }

 private:
  void take_frames() {
    const ffmpeg::Frame frame(av_frame_alloc());
    while (avcodec_receive_frame(decoder_.get(), frame.get()) >= 0) {
      if (!begun_) begin(*frame);
      if (resampler_) append(*frame);
    }
  }
  void begin(const AVFrame& frame) {
    begun_ = true;
    const auto seconds = [&](int stream, std::int64_t pts) {
      return pts == AV_NOPTS_VALUE ? 0.0 : static_cast<double>(pts) * av_q2d(container_->streams[stream]->time_base);
    };
    sound_.begins_s = seconds(stream_, frame.best_effort_timestamp);
    const int images = av_find_best_stream(container_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    if (images >= 0) sound_.begins_s -= seconds(images, container_->streams[images]->start_time);
    AVChannelLayout one = AV_CHANNEL_LAYOUT_MONO, recorded = frame.ch_layout;
    if (recorded.order == AV_CHANNEL_ORDER_UNSPEC) av_channel_layout_default(&recorded, recorded.nb_channels);
    SwrContext* made = nullptr;
    if (swr_alloc_set_opts2(&made, &one, AV_SAMPLE_FMT_FLT, Sound::kRate_hz, &recorded,
                            static_cast<AVSampleFormat>(frame.format), frame.sample_rate, 0, nullptr) < 0) {
      return;
    }
    resampler_.reset(made);
    if (swr_init(made) < 0) resampler_.reset();
  }
  void append(const AVFrame& frame) {
    const int room = swr_get_out_samples(resampler_.get(), frame.nb_samples);
    if (room <= 0) return;
    const std::size_t before = sound_.samples.size();
    sound_.samples.resize(before + static_cast<std::size_t>(room));
    auto* to = reinterpret_cast<std::uint8_t*>(sound_.samples.data() + before);
    const int got = swr_convert(resampler_.get(), &to, room, const_cast<const std::uint8_t**>(frame.extended_data),
                                frame.nb_samples);
    sound_.samples.resize(before + static_cast<std::size_t>(std::max(got, 0)));
  }

  ffmpeg::Container container_;
  ffmpeg::Codec decoder_;
  ffmpeg::Resampler resampler_;
  int stream_ = -1;
  bool begun_ = false;
  Sound sound_;
};

}  // namespace

std::optional<Sound> ffmpeg::sound_of(const std::filesystem::path& video) {
  const QuietFfmpeg quiet;
  return SoundReader(video).read();
}

}  // namespace coslam
