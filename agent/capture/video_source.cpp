// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <opencv2/core.hpp>
#include <string_view>

#include "agent/capture/decode.h"
#include "agent/capture/sources.h"
#include "common/base/error.h"
#include "common/base/file_kind.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/image/image_file.h"
#include "common/video/stream_decoder.h"

namespace coslam {
namespace {

// Times of a video's frames: the sidecar's, or the stream's, or evenly spaced at the container's rate where the stream
// has none or such to the millisecond that its format rounds to.
class VideoTimes {
 public:
  VideoTimes(const std::filesystem::path& video, double fallback_hz) : name_(video.string()), rate_hz_(fallback_hz) {
    const auto beside = times_beside(video);
    if (!beside) return;
    SourceTimes times = read_times(*beside);
    for (const std::string& guess : times.guesses) log_warn(guess);
    stamps_ = std::move(times.source_ns);
  }
  // Of the sidecar; 0 without.
  std::size_t count() const { return stamps_ ? stamps_->size() : 0; }
  // stream_s, stream_hz: what the stream gives the frame. Empty where the sidecar leaves it out, and past its last
  // line.
  std::optional<TimeNs> at(std::size_t frame, std::optional<double> stream_s, double stream_hz) {
    if (stamps_) return frame < stamps_->size() ? (*stamps_)[frame] : std::nullopt;
    constexpr TimeNs kRounding_ns = 1'000'000;
    if (frame == 0) begin(stream_s, stream_hz);
    const TimeNs even_ns = to_ns(static_cast<double>(frame) / rate_hz_);
    const TimeNs stream_ns = stream_s ? to_ns(*stream_s - first_s_) : 0;
    const bool is_usable = stream_ns > last_ns_ && std::abs(stream_ns - even_ns) > kRounding_ns;
    last_ns_ = is_usable ? stream_ns : std::max(even_ns, last_ns_ + (frame == 0 ? 0 : 1));
    return last_ns_;
  }

 private:
  void begin(std::optional<double> stream_s, double stream_hz) {
    constexpr double kSlowest_hz = 0.1, kFastest_hz = 1000;
    first_s_ = stream_s.value_or(0);
    const bool is_usable = stream_hz > kSlowest_hz && stream_hz < kFastest_hz;
    if (is_usable) rate_hz_ = stream_hz;
    if (is_usable || stream_s) return;
    log_warn(without_times(name_, rate_hz_));
  }

  const std::string name_;
  std::optional<std::vector<std::optional<TimeNs>>> stamps_;
  double rate_hz_;
  double first_s_ = 0;
  TimeNs last_ns_ = 0;
};

// Phones note how they were held. The calibration is of the sensor's pixels, so that is not obeyed, unless only the
// turned image has the calibration's size. By how much frames are to be turned, clockwise.
int turn_to_obey(const std::string& file, int turn_deg, cv::Size size, const SourceOptions& options) {
  if (turn_deg == 0) return 0;
  const bool across = turn_deg % 180 != 0;
  const bool turned =
      across && size.width != size.height && options.width_px == size.height && options.height_px == size.width;
  log_warn(file + ": the video says that it is to be turned by " + std::to_string(turn_deg) + " degrees; " +
           (turned ? "it is, as only then it has the calibration's size"
                   : "its frames are used as the sensor gave them, which is what calibrations are for"));
  return turned ? turn_deg : 0;
}

cv::Mat turned(const cv::Mat& frame, int turn_deg) {
  if (frame.empty() || turn_deg == 0) return frame;
  cv::Mat out;
  cv::rotate(frame, out, turn_deg == 90 ? cv::ROTATE_90_CLOCKWISE : cv::ROTATE_90_COUNTERCLOCKWISE);
  return out;
}

// By how the file begins; also MOV and 3GP.
bool is_mp4(const std::string& file) {
  std::array<char, 8> begin{};
  std::ifstream(file, std::ios::binary).read(begin.data(), begin.size());
  return std::string_view(begin.data() + 4, 4) == "ftyp";
}

std::unique_ptr<StreamDecoder> open_file(const std::string& file) {
  std::string why;
  auto decoder = StreamDecoder::open(file, false, &why);
  if (!decoder && std::filesystem::is_empty(file)) throw UserError(file + ": is empty");
  if (why == StreamDecoder::kNotAVideo) {
    throw UserError(file + (is_mp4(file) ? ": is a video without its index, as of a recorder that was stopped; "
                                           "programs as untrunc rebuild it"
                                         : ": neither a list of images (.csv, .txt) nor a video" + but_it_is(file)));
  }
  if (!decoder) throw UserError(file + ": cannot be played: " + why);
  if (decoder->videos() > 1) {
    log_warn(file + ": of its " + std::to_string(decoder->videos()) + " videos number " +
             std::to_string(decoder->video()) + " is played; ffmpeg -i FILE -map 0:v:" +
             (decoder->video() == 1 ? "1" : "0") + " -c copy OTHER.mkv takes out another");
  }
  return decoder;
}

// A video file. One frame is grabbed ahead, because only the grab tells whether there is another.
class VideoSource final : public ImageSource {
 public:
  VideoSource(const std::filesystem::path& file, const SourceOptions& options)
      : name_(file.string()),
        decoder_(open_file(name_)),
        span_(options),
        color_wanted_(options.color),
        duration_s_(options.duration_s),
        times_(file, options.rate_hz) {
    grab();
    while (grabbed_ns_ && span_.before(*grabbed_ns_)) grab();
    cv::Mat frame;
    while (grabbed_ns_ && (frame = mat_of(decoder_->bgr())).empty()) {
      ++frame_;
      grab();
    }
    if (frame.empty()) throw UserError(name_ + ": there is no readable frame in the time span asked for");
    turn_deg_ = turn_to_obey(name_, decoder_->turn_deg(), frame.size(), options);
    frame = turned(frame, turn_deg_);
    require_size(frame, options, name_);
    size_ = frame.size();
    const auto frames = static_cast<std::size_t>(decoder_->frames());  // as far as the container knows
    if (times_.count() > 0 && frames > 0 && frames != times_.count()) {
      log_warn(name_ + ": " + std::to_string(times_.count()) + " times beside it for " + std::to_string(frames) +
               " frames; played as far as both go");
    }
  }

  std::optional<Image> next() override {
    if (!grabbed_ns_) return std::nullopt;
    const cv::Mat frame = turned(mat_of(decoder_->bgr()), turn_deg_);
    Image image{FrameId(frame_++), span_.played_ns(*grabbed_ns_), to_grey(frame)};
    image.fault = size_fault(image.grey, size_);
    if (image.fault == ImageFault::kNone && decoder_->concealed()) image.fault = ImageFault::kConcealed;
    if (image.fault == ImageFault::kNone && color_wanted_) image.color = frame;
    if (image.fault != ImageFault::kNone && log_.pass()) {
      log_warn(name_ + ": frame " + std::to_string(image.frame.value) + " is damaged or of another size; passed over");
    }
    grab();
    return image;
  }

  bool skip() override {
    if (!grabbed_ns_) return false;
    ++frame_;
    grab();
    return true;
  }

  std::optional<TimeNs> peek_ns() const override {
    return grabbed_ns_ ? std::optional(span_.played_ns(*grabbed_ns_)) : std::nullopt;
  }

  std::optional<int> about_left() const override {
    const auto frames = static_cast<double>(decoder_->frames());
    if (frames <= 0) return std::nullopt;
    const double left = std::max(0.0, frames - static_cast<double>(position_)) + (grabbed_ns_ ? 1 : 0);
    const double played = duration_s_ ? *duration_s_ * decoder_->rate_hz() : left;
    return static_cast<int>(std::min(left, played));
  }

 private:
  void grab() {
    do {
      const bool is = decoder_->grab();
      grabbed_ns_ = is ? times_.at(position_++, decoder_->time_s(), decoder_->rate_hz()) : std::nullopt;
      if (!is) return warn_of_cut();
    } while (!grabbed_ns_ && position_ < times_.count());
    if (grabbed_ns_ && span_.after(*grabbed_ns_)) grabbed_ns_.reset();
  }

  void warn_of_cut() {
    const double missing = decoder_->missing_share();
    if (missing == 0) return;
    log_warn(name_ + ": ends before its own length: " + std::to_string(position_) + " of about " +
             std::to_string(std::lround(static_cast<double>(position_) / (1 - missing))) + " images are in it");
  }

  const std::string name_;
  std::unique_ptr<StreamDecoder> decoder_;
  PlayedSpan span_;
  bool color_wanted_;
  std::optional<double> duration_s_;
  VideoTimes times_;
  int turn_deg_ = 0;
  std::size_t position_ = 0;          // frames grabbed from the file
  std::optional<TimeNs> grabbed_ns_;  // source time of the frame grabbed ahead; empty at the end
  std::uint32_t frame_ = 0;
  cv::Size size_;
  LogLimiter log_;
};

}  // namespace

std::optional<std::filesystem::path> times_beside(const std::filesystem::path& video) {
  for (std::filesystem::path sidecar : {video, std::filesystem::path(video).replace_extension()}) {
    sidecar += ".timestamps.csv";
    if (std::filesystem::exists(sidecar)) return sidecar;
  }
  return std::nullopt;
}

std::unique_ptr<ImageSource> open_video(const std::filesystem::path& file, const SourceOptions& options) {
  return std::make_unique<VideoSource>(file, options);
}

}  // namespace coslam
