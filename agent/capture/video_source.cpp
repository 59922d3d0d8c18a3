// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <opencv2/videoio.hpp>

#include "agent/capture/decode.h"
#include "agent/capture/sources.h"
#include "common/base/error.h"
#include "common/base/log.h"

namespace coslam {
namespace {

// Times of a video's frames: the sidecar's, or the stream's, or evenly spaced at the container's rate where the stream
// has none or such to the millisecond that its format rounds to.
class VideoTimes {
 public:
  VideoTimes(const std::filesystem::path& video, double container_hz, double fallback_hz)
      : rate_hz_(container_hz > 0.1 && container_hz < 1000 ? container_hz : fallback_hz) {
    const auto beside = times_beside(video);
    if (!beside) return;
    SourceTimes times = read_times(*beside);
    for (const std::string& guess : times.guesses) log_warn(guess);
    stamps_ = std::move(times.source_ns);
  }
  // Of the sidecar; 0 without.
  std::size_t count() const { return stamps_ ? stamps_->size() : 0; }
  // stream_ms: that the container gives the frame. Empty where the sidecar leaves it out, and past its last line.
  std::optional<TimeNs> at(std::size_t frame, double stream_ms) {
    if (stamps_) return frame < stamps_->size() ? (*stamps_)[frame] : std::nullopt;
    constexpr TimeNs kRounding_ns = 1'000'000;
    if (frame == 0) first_ms_ = stream_ms;
    const TimeNs even_ns = to_ns(static_cast<double>(frame) / rate_hz_);
    const TimeNs stream_ns = to_ns((stream_ms - first_ms_) / 1000);
    const bool told = stream_ns > last_ns_ && std::abs(stream_ns - even_ns) > kRounding_ns;
    last_ns_ = told ? stream_ns : std::max(even_ns, last_ns_ + (frame == 0 ? 0 : 1));
    return last_ns_;
  }

 private:
  std::optional<std::vector<std::optional<TimeNs>>> stamps_;
  double rate_hz_;
  double first_ms_ = 0;
  TimeNs last_ns_ = 0;
};

// Only the readers of files: OpenCV would else ask cameras too.
cv::VideoCapture open_file(const std::string& file) {
  cv::VideoCapture capture(file, cv::CAP_FFMPEG);
  if (!capture.isOpened()) capture.open(file, cv::CAP_OPENCV_MJPEG);
  return capture;
}

// Phones note how they were held. The calibration is of the sensor's pixels, so that is not obeyed, unless only the
// turned image has the calibration's size.
void settle_rotation(const std::string& file, const SourceOptions& options, cv::VideoCapture* capture) {
  const int turn_deg = (static_cast<int>(std::lround(capture->get(cv::CAP_PROP_ORIENTATION_META))) % 360 + 360) % 360;
  if (turn_deg == 0) return;
  capture->set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
  const auto width = static_cast<int>(capture->get(cv::CAP_PROP_FRAME_WIDTH)),
             height = static_cast<int>(capture->get(cv::CAP_PROP_FRAME_HEIGHT));
  const bool across = turn_deg % 180 != 0;
  const bool turned = across && width != height && options.width_px == height && options.height_px == width;
  if (turned) capture->set(cv::CAP_PROP_ORIENTATION_AUTO, 1);
  log_warn(file + ": the video says that it is to be turned by " + std::to_string(turn_deg) + " degrees; " +
           (turned ? "it is, as only then it has the calibration's size"
                   : "its frames are used as the sensor gave them, which is what calibrations are for"));
}

// A video file. One frame is grabbed ahead, because only the grab tells whether there is another.
class VideoSource final : public ImageSource {
 public:
  VideoSource(const std::filesystem::path& file, const SourceOptions& options)
      : capture_(open_file(file.string())),
        span_(options),
        color_wanted_(options.color),
        times_(file, capture_.get(cv::CAP_PROP_FPS), options.rate_hz) {
    if (!capture_.isOpened()) throw UserError(file.string() + ": neither a list of images (.csv, .txt) nor a video");
    settle_rotation(file.string(), options, &capture_);
    grab();
    while (grabbed_ns_ && span_.before(*grabbed_ns_)) grab();
    while (grabbed_ns_ && first_image_.empty()) {
      first_image_ = retrieve();
      if (first_image_.empty()) drop_unreadable();
    }
    if (first_image_.empty())
      throw UserError(file.string() + ": there is no readable frame in the time span asked for");
    require_size(first_image_, options, file.string());
    size_ = first_image_.size();
    const double frames = capture_.get(cv::CAP_PROP_FRAME_COUNT);  // as far as the container knows
    if (times_.count() > 0 && frames > 0 && frames != static_cast<double>(times_.count())) {
      log_warn(file.string() + ": " + std::to_string(times_.count()) + " times beside it for " +
               std::to_string(std::llround(frames)) + " frames; played as far as both go");
    }
  }

  std::optional<Image> next() override {
    while (grabbed_ns_) {
      cv::Mat grey = first_image_.empty() ? retrieve() : std::exchange(first_image_, {});
      if (grey.size() != size_) {
        drop_unreadable();
        continue;
      }
      Image image{FrameId(frame_++), span_.played_ns(*grabbed_ns_), grey};
      image.color = std::exchange(color_, {});
      grab();
      return image;
    }
    return std::nullopt;
  }

  bool skip() override {
    if (!grabbed_ns_) return false;
    first_image_.release();
    ++frame_;
    grab();
    return true;
  }

  std::optional<TimeNs> peek_ns() const override {
    return grabbed_ns_ ? std::optional(span_.played_ns(*grabbed_ns_)) : std::nullopt;
  }
  std::size_t unreadable() const override { return unreadable_; }

 private:
  void grab() {
    do {
      const bool is = capture_.grab();
      grabbed_ns_ = is ? times_.at(position_++, capture_.get(cv::CAP_PROP_POS_MSEC)) : std::nullopt;
      if (!is) return;
    } while (!grabbed_ns_ && position_ < times_.count());
    if (grabbed_ns_ && span_.after(*grabbed_ns_)) grabbed_ns_.reset();
  }
  cv::Mat retrieve() {
    cv::Mat frame;
    if (!capture_.retrieve(frame)) return {};
    if (color_wanted_ && frame.type() == CV_8UC3) color_ = frame.clone();
    return to_grey(frame);
  }
  void drop_unreadable() {
    ++unreadable_;
    ++frame_;
    grab();
  }

  cv::VideoCapture capture_;
  PlayedSpan span_;
  bool color_wanted_;
  cv::Mat color_;  // of the frame last retrieved
  VideoTimes times_;
  std::size_t position_ = 0;          // frames grabbed from the file
  std::optional<TimeNs> grabbed_ns_;  // source time of the frame grabbed ahead; empty at the end
  std::uint32_t frame_ = 0;
  cv::Mat first_image_;
  cv::Size size_;
  std::size_t unreadable_ = 0;
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
