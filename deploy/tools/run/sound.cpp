// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/run/sound.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/channel_layout.h>
#include <libswresample/swresample.h>
}

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <opencv2/core.hpp>

#include "agent/capture/quiet_ffmpeg.h"

namespace coslam {
namespace {

constexpr double kMost_s = 600;
constexpr double kLeast_s = 1;
// Speech, steps and clatter; below it wind and the hum of the mains, above it nothing that a small microphone hears
// from afar.
constexpr double kLowest_hz = 150, kHighest_hz = 3600;
// The highest of a few million peaks of noise is 5.5 of its standard deviations high.
constexpr double kOfNoise = 9, kRival = 1.5;
constexpr double kElsewhere_s = 0.1;

template <class T, void (*kFree)(T**)>
struct Freed {
  void operator()(T* p) const { kFree(&p); }
};
using Container = std::unique_ptr<AVFormatContext, Freed<AVFormatContext, avformat_close_input>>;
using Decoder = std::unique_ptr<AVCodecContext, Freed<AVCodecContext, avcodec_free_context>>;
using Resampler = std::unique_ptr<SwrContext, Freed<SwrContext, swr_free>>;
using Packet = std::unique_ptr<AVPacket, Freed<AVPacket, av_packet_free>>;
using Frame = std::unique_ptr<AVFrame, Freed<AVFrame, av_frame_free>>;

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
    const Packet packet(av_packet_alloc());
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
    const Frame frame(av_frame_alloc());
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

  Container container_;
  Decoder decoder_;
  Resampler resampler_;
  int stream_ = -1;
  bool begun_ = false;
  Sound sound_;
};

// The ends fade: where a recording stops is no sound.
cv::Mat spectrum(std::span<const float> samples, int length) {
  cv::Mat padded = cv::Mat::zeros(1, length, CV_32F);
  auto* to = padded.ptr<float>();
  std::ranges::copy(samples, to);
  const std::size_t fade = samples.size() / 8;
  for (std::size_t i = 0; i < fade; ++i) {
    const auto gain =
        static_cast<float>(0.5 - 0.5 * std::cos(M_PI * static_cast<double>(i) / static_cast<double>(fade)));
    to[i] *= gain;
    to[samples.size() - 1 - i] *= gain;
  }
  cv::Mat out;
  cv::dft(padded, out, cv::DFT_COMPLEX_OUTPUT);
  return out;
}

}  // namespace

std::optional<Sound> sound_of(const std::filesystem::path& video) {
  const QuietFfmpeg quiet;
  return SoundReader(video).read();
}

std::optional<double> began_later_s(std::span<const float> first, std::span<const float> second, double rate_hz) {
  const auto least = static_cast<std::size_t>(kLeast_s * rate_hz);
  if (first.size() < least || second.size() < least) return std::nullopt;
  const int length = cv::getOptimalDFTSize(static_cast<int>(first.size() + second.size()));
  cv::Mat a = spectrum(first, length);
  const cv::Mat b = spectrum(second, length);
  for (int k = 0; k < length; ++k) {
    auto& x = a.at<std::complex<float>>(k);
    const double frequency_hz = rate_hz * std::min(k, length - k) / length;
    x *= std::conj(b.at<std::complex<float>>(k));
    const float size = std::abs(x);
    x = frequency_hz < kLowest_hz || frequency_hz > kHighest_hz || size == 0 ? 0 : x / size;
  }
  cv::Mat correlation;
  cv::dft(a, correlation, cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT | cv::DFT_SCALE);

  cv::Scalar mean, deviation;
  cv::meanStdDev(correlation, mean, deviation);
  const float* values = correlation.ptr<float>();
  const int best = static_cast<int>(std::max_element(values, values + length) - values);
  const auto away = static_cast<int>(kElsewhere_s * rate_hz);
  float elsewhere = 0;
  for (int k = 0; k < length; ++k) {
    const int apart = std::abs(k - best);
    if (std::min(apart, length - apart) > away) elsewhere = std::max(elsewhere, values[k]);
  }
  if (!(values[best] > kOfNoise * deviation[0] && values[best] > kRival * elsewhere)) return std::nullopt;
  const bool earlier = best >= static_cast<int>(first.size());  // negative lags lie behind
  return (earlier ? best - length : best) / rate_hz;
}

}  // namespace coslam
