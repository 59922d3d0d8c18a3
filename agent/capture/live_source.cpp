// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <opencv2/videoio.hpp>
#include <thread>

#include "agent/capture/decode.h"
#include "agent/capture/sources.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/flow/clock.h"

namespace coslam {
namespace {

constexpr const char* kV4l2 = "v4l2:";
constexpr const char* kGst = "gst:";

bool open_v4l2(cv::VideoCapture& capture, const std::string& device) {
  const auto index = parse_integer(device);
  const bool open = index ? capture.open(static_cast<int>(*index), cv::CAP_V4L2) : capture.open(device, cv::CAP_V4L2);
  capture.set(cv::CAP_PROP_BUFFERSIZE, 1);  // an old image is worth less than none
  return open;
}

bool open_gst(cv::VideoCapture& capture, std::string pipeline) {
  if (pipeline.find("appsink") == std::string::npos) {
    pipeline += " ! videoconvert ! video/x-raw,format=GRAY8 ! appsink drop=true max-buffers=1 sync=false";
  }
  return capture.open(pipeline, cv::CAP_GSTREAMER);
}

bool open_stream(cv::VideoCapture& capture, const std::string& url) {
  constexpr int kTimeout_ms = 5000;
  return capture.open(url, cv::CAP_FFMPEG,
                      {cv::CAP_PROP_OPEN_TIMEOUT_MSEC, kTimeout_ms, cv::CAP_PROP_READ_TIMEOUT_MSEC, kTimeout_ms});
}

// A camera or stream. It is opened again, ever more seldom, when it fails.
class LiveSource final : public ImageSource {
 public:
  LiveSource(std::string uri, const SourceOptions& options) : uri_(std::move(uri)), duration_s_(options.duration_s) {
    if (!open()) throw UserError("the source '" + uri_ + "' cannot be opened");
    cv::Mat first;
    for (int i = 0; i < 10 && first.empty(); ++i) first = read();  // a camera may warm up with empty frames
    if (first.empty()) throw UserError("the source '" + uri_ + "' gives no image");
    require_size(first, options, "the image of '" + uri_ + "'");
    size_ = first.size();
  }

  std::optional<Image> next() override {
    while (!stopped_ && !ended_) {
      cv::Mat grey = read();
      const TimeNs now_ns = utc_now_ns();
      if (!first_ns_) first_ns_ = now_ns;
      if (duration_s_ && now_ns - *first_ns_ >= to_ns(*duration_s_)) ended_ = true;
      if (ended_) break;
      if (grey.size() == size_) return Image{FrameId(frame_++), now_ns, grey};
      ++frame_;
      ++unreadable_;
      if (grey.empty()) reopen();
    }
    return std::nullopt;
  }

  bool skip() override { return next().has_value(); }
  std::optional<TimeNs> peek_ns() const override { return std::nullopt; }
  bool live() const override { return true; }
  std::size_t unreadable() const override { return unreadable_; }
  void stop() override { stopped_ = true; }

 private:
  bool open() {
    try {
      if (uri_.starts_with(kV4l2)) return open_v4l2(capture_, uri_.substr(std::string_view(kV4l2).size()));
      if (uri_.starts_with(kGst)) return open_gst(capture_, uri_.substr(std::string_view(kGst).size()));
      return open_stream(capture_, uri_);
    } catch (const cv::Exception&) {
      return false;
    }
  }

  cv::Mat read() {
    cv::Mat frame;
    return capture_.read(frame) ? to_grey(frame) : cv::Mat();
  }

  void reopen() {
    if (uri_.starts_with(kGst)) {
      ended_ = true;  // the end of a pipeline cannot be told from its failure
      return;
    }
    if (log_.pass()) log_warn("the source '" + uri_ + "' gives no image, opening it again");
    capture_.release();
    auto wait = std::chrono::milliseconds(100);
    do {
      sleep(wait);
      wait = std::min(wait * 2, std::chrono::milliseconds(3000));
    } while (!stopped_ && !open());
  }

  void sleep(std::chrono::milliseconds duration) const {
    const auto until = std::chrono::steady_clock::now() + duration;
    while (!stopped_ && std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  std::string uri_;
  std::optional<double> duration_s_;
  cv::VideoCapture capture_;
  cv::Size size_;
  std::optional<TimeNs> first_ns_;
  std::uint32_t frame_ = 0;
  std::size_t unreadable_ = 0;
  bool ended_ = false;
  LogLimiter log_;
  std::atomic<bool> stopped_ = false;
};

}  // namespace

bool is_live_uri(const std::string& uri) {
  constexpr std::array<const char*, 6> kSchemes = {kV4l2, kGst, "rtsp://", "rtsps://", "http://", "https://"};
  return std::any_of(kSchemes.begin(), kSchemes.end(), [&](const char* scheme) { return uri.starts_with(scheme); });
}

std::unique_ptr<ImageSource> open_live(const std::string& uri, const SourceOptions& options) {
  return std::make_unique<LiveSource>(uri, options);
}

}  // namespace coslam
