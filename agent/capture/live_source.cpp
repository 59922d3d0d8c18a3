// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <string_view>
#include <thread>

#include "agent/capture/camera_mode.h"
#include "agent/capture/decode.h"
#include "agent/capture/sources.h"
#include "agent/capture/v4l2_camera.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"
#include "common/dataset/live_topic.h"
#include "common/dataset/sequence.h"
#include "common/flow/clock.h"
#include "common/image/image_file.h"
#include "common/video/pipeline.h"
#include "common/video/stream_decoder.h"

namespace coslam {
namespace {

constexpr std::string_view kV4l2 = "v4l2:", kGst = "gst:";

// What gives pictures until it fails.
class Camera {
 public:
  virtual ~Camera() = default;
  struct Picture {
    cv::Mat grey;  // CV_8UC1; empty: it could not be read
    bool concealed = false;
  };
  // The next one; empty: the camera has failed, or its end is reached.
  virtual std::optional<Picture> read() = 0;
  virtual bool has_end() const { return false; }  // after which there is nothing more
  virtual void stop() {}                          // from any thread
};

void sleep_until(std::chrono::steady_clock::time_point until, const std::atomic<bool>& stopped) {
  constexpr std::chrono::milliseconds kStep{50};
  for (auto now = std::chrono::steady_clock::now(); !stopped && now < until; now = std::chrono::steady_clock::now()) {
    std::this_thread::sleep_until(std::min(until, now + kStep));
  }
}

class LocalCamera final : public Camera {
 public:
  explicit LocalCamera(std::unique_ptr<V4l2Camera> camera) : camera_(std::move(camera)) {}
  std::optional<Picture> read() override {
    auto grey = camera_->read(stopped_);
    return grey ? std::optional(Picture{*grey}) : std::nullopt;
  }
  void stop() override { stopped_ = true; }

 private:
  std::unique_ptr<V4l2Camera> camera_;
  std::atomic<bool> stopped_ = false;
};

class PlayedPipeline final : public Camera {
 public:
  explicit PlayedPipeline(std::unique_ptr<Pipeline> pipeline) : pipeline_(std::move(pipeline)) {}
  std::optional<Picture> read() override {
    Pipeline::Raw raw;
    if (!pipeline_->read(&raw)) return std::nullopt;
    const coslam::Picture& plane = raw.first_plane;
    if (raw.encoding.empty() && log_.pass())
      log_warn("the pipeline gives pictures in the format " + std::string(raw.format) + ", which is not read here");
    return Picture{grey_.decode(RawImage{static_cast<std::size_t>(plane.width_px),
                                         static_cast<std::size_t>(plane.height_px),
                                         raw.encoding,
                                         false,
                                         plane.octets_per_row,
                                         {plane.pixels, raw.octets}})};
  }

 private:
  std::unique_ptr<Pipeline> pipeline_;
  GreyReader grey_;
  LogLimiter log_;
};

class Stream final : public Camera {
 public:
  explicit Stream(std::unique_ptr<StreamDecoder> decoder) : decoder_(std::move(decoder)) {}
  std::optional<Picture> read() override {
    if (!decoder_->grab()) return std::nullopt;
    if (has_end()) wait_until_due();
    return Picture{to_grey(mat_of(decoder_->bgr())), decoder_->concealed()};
  }
  bool has_end() const override { return decoder_->has_end(); }
  void stop() override {
    stopped_ = true;
    decoder_->stop();
  }

 private:
  // A file comes faster than it is to be played.
  void wait_until_due() {
    const std::optional<double> time_s = decoder_->time_s();
    if (!time_s) return;
    const auto time = std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(*time_s));
    if (!start_) start_ = std::chrono::steady_clock::now() - time;
    sleep_until(*start_ + time, stopped_);
  }

  std::unique_ptr<StreamDecoder> decoder_;
  std::atomic<bool> stopped_ = false;
  std::optional<std::chrono::steady_clock::time_point> start_;
};

// v4l2:DEVICE[?size=WxH][&fps=N][&format=FOURCC]. Null: it cannot be opened. Throws UserError for what the device does
// not do.
std::unique_ptr<Camera> open_v4l2(const std::string& uri, std::string* why) {
  const CameraMode mode = parse_camera_mode(uri);
  auto driver = CameraDriver::open(parse_integer(mode.device) ? "/dev/video" + mode.device : mode.device, why);
  auto camera = driver ? V4l2Camera::start(std::move(driver), mode, uri, why) : nullptr;
  return camera ? std::make_unique<LocalCamera>(std::move(camera)) : nullptr;
}

std::unique_ptr<Camera> open_gst(std::string words, const std::atomic<bool>& stopped, std::string* why) {
  if (words.find("appsink") == std::string::npos) {
    words += " ! videoconvert ! video/x-raw,format=GRAY8 ! appsink drop=true max-buffers=1 sync=false";
  }
  auto pipeline = pipelines().start(words, why, stopped);
  return pipeline ? std::make_unique<PlayedPipeline>(std::move(pipeline)) : nullptr;
}

// Null: it cannot be opened, and why. Throws UserError for what it does not do. stopped: opening ends soon after that
// is set.
std::unique_ptr<Camera> open_camera(const std::string& uri, const std::atomic<bool>& stopped, std::string* why) {
  if (uri.starts_with(kV4l2)) return open_v4l2(uri, why);
  if (uri.starts_with(kGst)) return open_gst(uri.substr(kGst.size()), stopped, why);
  auto decoder = StreamDecoder::open(uri, true, why, &stopped);
  return decoder ? std::make_unique<Stream>(std::move(decoder)) : nullptr;
}

// A camera or stream. It is opened again, ever more seldom, when it fails.
class LiveSource final : public ImageSource {
 public:
  LiveSource(std::string uri, const SourceOptions& options)
      : uri_(std::move(uri)), name_(shown_source(uri_)), duration_s_(options.duration_s) {
    std::string why;
    camera_ = open_camera(uri_, stopped_, &why);
    if (!camera_ && uri_.starts_with(kV4l2)) why += "; coslam doctor lists the cameras of this machine";
    if (!camera_) throw UserError("the source '" + name_ + "' cannot be opened: " + why);
    std::optional<Camera::Picture> first;
    // A camera may warm up with empty frames.
    for (int i = 0; i < 10 && (!first || first->grey.empty()); ++i) first = camera_->read();
    if (!first || first->grey.empty()) throw UserError("the source '" + name_ + "' gives no image");
    require_size(first->grey, options, "the image of '" + name_ + "'");
    size_ = first->grey.size();
  }

  std::optional<Image> next() override {
    if (failed_) reopen();
    if (stopped_ || ended_) return std::nullopt;
    auto picture = camera_->read();
    const TimeNs now_ns = utc_now_ns();
    if (!first_ns_) first_ns_ = now_ns;
    if (duration_s_ && now_ns - *first_ns_ >= to_ns(*duration_s_)) ended_ = true;
    if (!picture && (camera_->has_end() || uri_.starts_with(kGst))) ended_ = true;  // a pipeline's cannot be told
    if (stopped_ || ended_) return std::nullopt;
    Image image{FrameId(frame_++), now_ns, picture ? picture->grey : cv::Mat()};
    image.fault = fault_of(picture);
    failed_ = !picture;
    if (image.fault != ImageFault::kNone && log_.pass()) warn(image);
    return image;
  }

  bool skip() override { return next().has_value(); }
  std::optional<TimeNs> peek_ns() const override { return std::nullopt; }
  bool live() const override { return true; }
  void stop() override {
    stopped_ = true;
    const std::lock_guard lock(mutex_);
    if (camera_) camera_->stop();
  }

 private:
  ImageFault fault_of(const std::optional<Camera::Picture>& picture) const {
    if (!picture) return ImageFault::kMissing;
    const ImageFault fault = size_fault(picture->grey, size_);
    return fault == ImageFault::kNone && picture->concealed ? ImageFault::kConcealed : fault;
  }

  void warn(const Image& image) const {
    const std::string source_name = "the source '" + name_ + "' ";
    if (image.fault == ImageFault::kMissing) {
      log_warn(source_name + "gives no image, opening it again");
    } else if (image.fault == ImageFault::kResized) {
      log_warn(source_name + "gives images of " + std::to_string(image.grey.cols) + "x" +
               std::to_string(image.grey.rows) + " pixels instead of " + std::to_string(size_.width) + "x" +
               std::to_string(size_.height) + ", as the calibration is for; they are left out");
    } else {
      log_warn(source_name + "gives a damaged image; it is left out");
    }
  }

  // It may have come back in another mode, which waits for a better one.
  std::unique_ptr<Camera> opened_again() {
    try {
      std::string why;
      return open_camera(uri_, stopped_, &why);
    } catch (const UserError& e) {
      if (log_.pass()) log_warn(e.what());
      return nullptr;
    }
  }

  void reopen() {
    auto wait = std::chrono::milliseconds(100);
    const auto put = [&](std::unique_ptr<Camera> camera) {
      const std::lock_guard lock(mutex_);
      camera_ = std::move(camera);
    };
    put(nullptr);
    do {
      sleep_until(std::chrono::steady_clock::now() + wait, stopped_);
      wait = std::min(wait * 2, std::chrono::milliseconds(3000));
      if (!stopped_) put(opened_again());
    } while (!stopped_ && !camera_);
    failed_ = false;
  }

  const std::string uri_, name_;
  std::optional<double> duration_s_;
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;  // of the pointer, against stop()
  std::unique_ptr<Camera> camera_;
  cv::Size size_;
  std::optional<TimeNs> first_ns_;
  std::uint32_t frame_ = 0;
  bool failed_ = false, ended_ = false;
  LogLimiter log_;
};

}  // namespace

bool is_live_uri(const std::string& uri) {
  constexpr auto kSchemes = std::to_array<std::string_view>(
      {kV4l2, kGst, kRos2Scheme, "rtsp://", "rtsp+udp://", "rtsps://", "http://", "https://"});
  return std::ranges::any_of(kSchemes, [&](std::string_view scheme) { return uri.starts_with(scheme); });
}

std::unique_ptr<ImageSource> open_live(const std::string& uri, const SourceOptions& options) {
  return std::make_unique<LiveSource>(uri, options);
}

}  // namespace coslam
