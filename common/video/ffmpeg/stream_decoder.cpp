// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/video/stream_decoder.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "common/image/cut_off.h"
#include "common/video/ffmpeg/decoded_damage.h"
#include "common/video/ffmpeg/owned.h"
#include "common/video/ffmpeg/plug_in.h"
#include "common/video/ffmpeg/versions.h"

namespace coslam {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kPatience{5};
constexpr double kHealed_s = 1;
constexpr const char* kNoVideo = "there is no video in it";

class FfmpegDecoder final : public StreamDecoder {
 public:
  FfmpegDecoder(std::string url, bool live, const std::atomic<bool>* stopped)
      : live_(live), also_stopped_(stopped), url_(std::move(url)) {}
  ~FfmpegDecoder() override { avformat_close_input(&container_); }
  FfmpegDecoder(const FfmpegDecoder&) = delete;
  FfmpegDecoder& operator=(const FfmpegDecoder&) = delete;

  // Empty: it is open; else why not.
  std::string open() {
    const int error = open_container();
    if (error == AVERROR_EXIT) return "it does not answer";
    if (error == AVERROR_INVALIDDATA || error == AVERROR_EOF) return kNotAVideo;
    if (error == AVERROR(EIO)) return error_text(error) + ": no such host, a broken line, or no video";
    if (error < 0) return error_text(error);
    return open_codec();
  }

  bool grab() override {
    constexpr int kMostErrors = 100;  // in succession
    decoded_ = false;
    for (int errors = 0; errors < kMostErrors;) {
      const int got = avcodec_receive_frame(codec_.get(), frame_.get());
      if (got == 0) {
        decoded_ = true;
        last_pts_ = frame_->best_effort_timestamp;
        note_damage();
        return true;
      }
      if (got == AVERROR_INVALIDDATA) {  // of a frame that was fed before; others follow
        ++errors;
        cut_ = true;
        continue;
      }
      if (got != AVERROR(EAGAIN) || stopped_) return false;
      const int fed = feed();
      if (fed == AVERROR_INVALIDDATA && is_of_single_images()) {  // this one cannot be decoded
        cut_ = false;
        return true;
      }
      if (fed == AVERROR_EOF) return false;
    }
    return false;
  }

  Picture bgr() override {
    if (!decoded_ || frame_->width <= 0 || frame_->height <= 0) return {};
    const auto format = static_cast<AVPixelFormat>(frame_->format);
    scaler_.reset(sws_getCachedContext(scaler_.release(), frame_->width, frame_->height, format, frame_->width,
                                       frame_->height, AV_PIX_FMT_BGR24, SWS_BICUBIC, nullptr, nullptr, nullptr));
    if (!scaler_) return {};
    // The scaler writes in steps of its vectors, past the end of a row.
    constexpr int kSlack = 64;
    const int row = 3 * (frame_->width + kSlack);
    rows_.resize(static_cast<std::size_t>(row) * static_cast<std::size_t>(frame_->height));
    std::uint8_t* const to[4] = {rows_.data(), nullptr, nullptr, nullptr};
    const int steps[4] = {row, 0, 0, 0};
    if (sws_scale(scaler_.get(), frame_->data, frame_->linesize, 0, frame_->height, to, steps) != frame_->height) {
      return {};
    }
    return {frame_->width, frame_->height, 3, 1, static_cast<std::size_t>(row), rows_.data()};
  }

  std::optional<double> time_s() const override {
    const std::int64_t pts = frame_->best_effort_timestamp;
    if (!decoded_ || pts == AV_NOPTS_VALUE || !has_times()) return std::nullopt;
    const std::int64_t start = stream().start_time == AV_NOPTS_VALUE ? 0 : stream().start_time;
    return static_cast<double>(pts - start) * av_q2d(stream().time_base);
  }
  bool concealed() const override { return decoded_ && damaged_; }

  bool has_end() const override { return has_end_; }
  double rate_hz() const override {
    const AVRational rate =
        has_times() ? av_guess_frame_rate(container_, container_->streams[video_], nullptr) : codec_->framerate;
    return rate.num > 0 && rate.den > 0 ? av_q2d(rate) : 0;
  }
  std::int64_t frames() const override {
    if (stream().nb_frames > 0 || container_->duration <= 0) return stream().nb_frames;
    return std::llround(static_cast<double>(container_->duration) / AV_TIME_BASE * rate_hz());
  }
  int videos() const override { return static_cast<int>(std::ranges::count_if(streams(), is_video)); }
  int video() const override {
    return static_cast<int>(std::ranges::count_if(streams().first(static_cast<std::size_t>(video_)), is_video)) + 1;
  }
  double missing_share() const override {
    constexpr double kWorthAWord_s = 0.5;
    // Else it is of what is there.
    const bool is_in_stream = container_->duration_estimation_method == AVFMT_DURATION_FROM_STREAM;
    if (container_->duration <= 0 || !is_in_stream || last_pts_ == AV_NOPTS_VALUE) return 0;
    const auto seconds = [&](std::int64_t pts) { return static_cast<double>(pts) * av_q2d(stream().time_base); };
    const double end_s = seconds(last_pts_) + (rate_hz() > 0 ? 1 / rate_hz() : 0), missing_s = length_s() - end_s;
    const double start_s = stream().start_time == AV_NOPTS_VALUE ? 0 : seconds(stream().start_time);
    return missing_s < kWorthAWord_s ? 0 : missing_s / (missing_s + end_s - start_s);
  }
  int turn_deg() const override {
    const std::uint8_t* matrix = ffmpeg::display_matrix(stream());
    if (matrix == nullptr) return 0;
    const double turn = av_display_rotation_get(reinterpret_cast<const std::int32_t*>(matrix));
    return std::isfinite(turn) ? static_cast<int>((std::lround(-turn) % 360 + 360) % 360) : 0;
  }

  void stop() override { stopped_ = true; }

 private:
  const AVStream& stream() const { return *container_->streams[video_]; }
  std::span<AVStream* const> streams() const { return {container_->streams, container_->nb_streams}; }
  static bool is_video(const AVStream* s) {
    return s->codecpar->codec_type == AVMEDIA_TYPE_VIDEO && (s->disposition & AV_DISPOSITION_ATTACHED_PIC) == 0;
  }

  // Frames one after another and nothing else have none, but FFmpeg makes them up at 25 a second.
  bool has_times() const { return (container_->iformat->flags & AVFMT_NOTIMESTAMPS) == 0; }

  // Of the video; others in the container may be longer.
  double length_s() const {
    return stream().duration > 0 ? static_cast<double>(stream().duration) * av_q2d(stream().time_base)
                                 : static_cast<double>(container_->duration) / AV_TIME_BASE;
  }

  static int interrupted(void* self) {
    const auto& me = *static_cast<const FfmpegDecoder*>(self);
    const bool stopped = me.stopped_ || (me.also_stopped_ != nullptr && *me.also_stopped_);
    return stopped || (me.live_ && Clock::now() > me.deadline_) ? 1 : 0;
  }

  static std::string error_text(int error) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    av_strerror(error, text.data(), text.size());
    return text.data();
  }

  int open_container() {
    static std::once_flag once;
    std::call_once(once, [] {
      avformat_network_init();
      av_log_set_level(AV_LOG_QUIET);  // what is wrong is said by who reads the frames
    });
    container_ = avformat_alloc_context();
    if (container_ == nullptr) return AVERROR(ENOMEM);
    container_->interrupt_callback = {&FfmpegDecoder::interrupted, this};
    deadline_ = Clock::now() + kPatience;
    AVDictionary* options = nullptr;
    constexpr std::string_view kOverUdp = "rtsp+udp://";
    const bool over_udp = url_.starts_with(kOverUdp);
    if (over_udp) url_ = "rtsp://" + url_.substr(kOverUdp.size());
    if (url_.starts_with("rtsp")) av_dict_set(&options, "rtsp_transport", over_udp ? "udp" : "tcp", 0);
    if (live_) av_dict_set(&options, "fflags", "nobuffer", 0);
    // A path may look like a protocol: clip:2.mp4.
    const std::string name = live_ ? url_ : "file:" + url_;
    const int opened = avformat_open_input(&container_, name.c_str(), nullptr, &options);  // frees it when it fails
    av_dict_free(&options);
    deadline_ = Clock::now() + kPatience;
    if (opened != 0) return opened;
    has_end_ = !live_ || container_->duration > 0;
    if (has_end_) container_->flags &= ~AVFMT_FLAG_NOBUFFER;  // what is looked at here would be missing later
    return avformat_find_stream_info(container_, nullptr);
  }

  std::string open_codec() {
    const AVCodec* codec = nullptr;
    video_ = av_find_best_stream(container_, AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
    if (video_ == AVERROR_DECODER_NOT_FOUND) return "its video is coded in a way that is not read here";
    if (video_ < 0 || codec == nullptr) return kNoVideo;
    codec_.reset(avcodec_alloc_context3(codec));
    if (!codec_ || !packet_ || !frame_) return error_text(AVERROR(ENOMEM));
    if (const int error = avcodec_parameters_to_context(codec_.get(), stream().codecpar); error < 0)
      return error_text(error);
    codec_->pkt_timebase = stream().time_base;
    codec_->flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;
    codec_->framerate = {0, 1};
    codec_->thread_count = 0;
    if (!has_end_) {  // threads by frames would hold some back
      codec_->thread_type = FF_THREAD_SLICE;
      codec_->flags |= AV_CODEC_FLAG_LOW_DELAY;
    }
    const int error = avcodec_open2(codec_.get(), codec, nullptr);
    return error < 0 ? error_text(error) : std::string();
  }

  // Gives the decoder the next packet of the video.
  int feed() {
    do {
      av_packet_unref(packet_.get());
      deadline_ = Clock::now() + kPatience;
      if (av_read_frame(container_, packet_.get()) < 0) return avcodec_send_packet(codec_.get(), nullptr);
    } while (packet_->stream_index != video_);
    cut_ |=
        (packet_->flags & AV_PKT_FLAG_CORRUPT) != 0 ||
        (codec_->codec_id == AV_CODEC_ID_MJPEG && is_cut_off({packet_->data, static_cast<std::size_t>(packet_->size)}));
    return avcodec_send_packet(codec_.get(), packet_.get());
  }

  bool is_of_single_images() const {
    const AVCodecDescriptor* d = avcodec_descriptor_get(codec_->codec_id);
    return d != nullptr && (d->props & AV_CODEC_PROP_INTRA_ONLY) != 0;
  }

  void note_damage() {
    constexpr double kSlowest_hz = 1, kFastest_hz = 120;  // what containers say may be no rate
    const int heals_in =
        is_of_single_images() ? 1 : static_cast<int>(kHealed_s * std::clamp(rate_hz(), kSlowest_hz, kFastest_hz));
    damaged_ = damage_.note(*frame_, std::exchange(cut_, false), heals_in);
  }

  const bool live_;
  const std::atomic<bool>* const also_stopped_;
  std::string url_;
  std::atomic<bool> stopped_ = false;
  Clock::time_point deadline_;
  AVFormatContext* container_ = nullptr;
  int video_ = -1;
  ffmpeg::Codec codec_;
  ffmpeg::Packet packet_{av_packet_alloc()};
  ffmpeg::Frame frame_{av_frame_alloc()};
  ffmpeg::Scaler scaler_;
  std::vector<std::uint8_t> rows_;  // of the newest picture
  std::int64_t last_pts_ = AV_NOPTS_VALUE;
  bool has_end_ = true, decoded_ = false, cut_ = false, damaged_ = false;
  DecodedDamage damage_;
};

}  // namespace

std::unique_ptr<StreamDecoder> ffmpeg::open_stream(const std::string& url, bool live, std::string* why,
                                                   const std::atomic<bool>* stopped) {
  auto decoder = std::make_unique<FfmpegDecoder>(url, live, stopped);
  *why = decoder->open();
  if (!why->empty()) return nullptr;
  return decoder;
}

}  // namespace coslam
