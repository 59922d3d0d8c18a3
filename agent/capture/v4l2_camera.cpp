// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/v4l2_camera.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/base/text.h"

namespace coslam {
namespace {

constexpr std::string_view kJpeg = "jpeg";

struct PixelFormat {
  std::uint32_t code;
  std::string_view encoding;  // as grey_of() knows it, or kJpeg
};

constexpr std::array kFormats = std::to_array<PixelFormat>({
    {V4L2_PIX_FMT_GREY, "mono8"},
    {V4L2_PIX_FMT_Y10, "mono16"},
    {V4L2_PIX_FMT_Y12, "mono16"},
    {V4L2_PIX_FMT_Y16, "mono16"},
    {V4L2_PIX_FMT_YUYV, "yuyv"},
    {V4L2_PIX_FMT_YVYU, "yuyv"},
    {V4L2_PIX_FMT_UYVY, "uyvy"},
    {V4L2_PIX_FMT_VYUY, "uyvy"},
    {V4L2_PIX_FMT_NV12, "nv12"},
    {V4L2_PIX_FMT_NV21, "nv21"},
    {V4L2_PIX_FMT_NV24, "nv24"},
    {V4L2_PIX_FMT_YUV420, "i420"},
    {V4L2_PIX_FMT_YVU420, "yv12"},
    {V4L2_PIX_FMT_BGR24, "bgr8"},
    {V4L2_PIX_FMT_RGB24, "rgb8"},
    {V4L2_PIX_FMT_XBGR32, "bgra8"},
    {V4L2_PIX_FMT_ABGR32, "bgra8"},
    {V4L2_PIX_FMT_BGR32, "bgra8"},
    {V4L2_PIX_FMT_SRGGB8, "bayer_rggb8"},
    {V4L2_PIX_FMT_SBGGR8, "bayer_bggr8"},
    {V4L2_PIX_FMT_SGBRG8, "bayer_gbrg8"},
    {V4L2_PIX_FMT_SGRBG8, "bayer_grbg8"},
    {V4L2_PIX_FMT_SRGGB16, "bayer_rggb16"},
    {V4L2_PIX_FMT_SBGGR16, "bayer_bggr16"},
    {V4L2_PIX_FMT_SGBRG16, "bayer_gbrg16"},
    {V4L2_PIX_FMT_SGRBG16, "bayer_grbg16"},
    {V4L2_PIX_FMT_MJPEG, kJpeg},
    {V4L2_PIX_FMT_JPEG, kJpeg},
});

// Empty: not read here.
std::string_view encoding_of(std::uint32_t code) {
  const auto* at = std::ranges::find(kFormats, code, &PixelFormat::code);
  return at == kFormats.end() ? std::string_view() : at->encoding;
}

std::uint32_t code_of(const std::string& letters) {
  std::uint32_t code = 0;
  for (std::size_t i = 0; i < 4; ++i)
    code |= static_cast<std::uint32_t>(static_cast<unsigned char>(letters[i])) << 8 * i;
  return code;
}

std::string letters_of(std::uint32_t code) {
  std::string letters;
  for (unsigned shift = 0; shift < 32; shift += 8) letters.push_back(static_cast<char>(code >> shift & 255U));
  return letters;
}

class KernelDriver final : public CameraDriver {
 public:
  explicit KernelDriver(int descriptor) : descriptor_(descriptor) {}
  ~KernelDriver() override {
    for (const auto& part : mapped_) munmap(const_cast<std::uint8_t*>(part.data()), part.size());
    close(descriptor_);
  }
  KernelDriver(const KernelDriver&) = delete;
  KernelDriver& operator=(const KernelDriver&) = delete;

  int control(unsigned long request, void* argument) override {
    int done = -1;
    do done = ioctl(descriptor_, request, argument);
    while (done < 0 && errno == EINTR);
    return done < 0 ? errno : 0;
  }
  std::span<const std::uint8_t> map(std::size_t octets, std::int64_t offset) override {
    void* at = mmap(nullptr, octets, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, offset);
    if (at == MAP_FAILED) return {};
    return mapped_.emplace_back(static_cast<const std::uint8_t*>(at), octets);
  }
  bool wait(std::chrono::milliseconds most) override {
    pollfd ready{descriptor_, POLLIN, 0};
    return poll(&ready, 1, static_cast<int>(most.count())) > 0;
  }

 private:
  int descriptor_;
  std::vector<std::span<const std::uint8_t>> mapped_;
};

// The format that is asked for, or is set, or is the first of the driver's that is read here; 0: there is none.
std::uint32_t chosen_format(CameraDriver& driver, const CameraMode& mode, std::uint32_t set) {
  if (!mode.format.empty()) return code_of(mode.format);
  if (!encoding_of(set).empty()) return set;
  v4l2_fmtdesc format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; driver.control(VIDIOC_ENUM_FMT, &format) == 0; ++format.index) {
    if (!encoding_of(format.pixelformat).empty()) return format.pixelformat;
  }
  return 0;
}

// Sets the format and the size. Not empty: why not, as the end of a sentence.
std::string set_format(CameraDriver& driver, const CameraMode& mode, const std::string& name, v4l2_format* format) {
  format->type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int error = driver.control(VIDIOC_G_FMT, format); error != 0) return std::strerror(error);
  v4l2_pix_format& pixels = format->fmt.pix;
  const std::uint32_t wanted = chosen_format(driver, mode, pixels.pixelformat);
  if (wanted == 0) return "it gives no format that is read here, but " + letters_of(pixels.pixelformat);
  pixels.pixelformat = wanted;
  pixels.bytesperline = pixels.sizeimage = 0;  // as the driver has it
  pixels.field = V4L2_FIELD_ANY;
  if (mode.width_px > 0) {
    pixels.width = static_cast<std::uint32_t>(mode.width_px);
    pixels.height = static_cast<std::uint32_t>(mode.height_px);
  }
  if (const int error = driver.control(VIDIOC_S_FMT, format); error != 0 && mode.format.empty())
    return std::strerror(error);
  if (pixels.pixelformat != wanted || encoding_of(wanted).empty())
    throw UserError(name + ": the camera does not give the format " + letters_of(wanted) +
                    (pixels.pixelformat == wanted ? " in a way that is read here" : ""));
  if (mode.width_px > 0 &&
      (static_cast<int>(pixels.width) != mode.width_px || static_cast<int>(pixels.height) != mode.height_px)) {
    throw UserError(name + ": the camera gives " + std::to_string(pixels.width) + "x" + std::to_string(pixels.height) +
                    " instead");
  }
  return {};
}

void set_rate(CameraDriver& driver, double rate_hz, const std::string& name) {
  constexpr std::uint32_t kParts = 1000;
  constexpr double kMuch = 0.05;
  if (rate_hz <= 0) return;
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  parameters.parm.capture.timeperframe = {kParts, static_cast<std::uint32_t>(std::lround(kParts * rate_hz))};
  const int error = driver.control(VIDIOC_S_PARM, &parameters);
  const v4l2_fract& period = parameters.parm.capture.timeperframe;
  if (error != 0 || period.numerator == 0) {
    log_warn(name + ": the camera's rate cannot be set");
    return;
  }
  const double rate = static_cast<double>(period.denominator) / period.numerator;
  if (std::abs(rate - rate_hz) > kMuch * rate_hz)
    log_warn(name + ": the camera gives " + format_double(rate) + " images a second instead");
}

v4l2_buffer buffer_of(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

}  // namespace

std::unique_ptr<CameraDriver> CameraDriver::open(const std::string& device, std::string* why) {
  const int descriptor = ::open(device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    *why = std::strerror(errno);
    return nullptr;
  }
  auto driver = std::make_unique<KernelDriver>(descriptor);
  v4l2_capability is{};
  if (driver->control(VIDIOC_QUERYCAP, &is) != 0) {
    *why = device + " is no camera";
    return nullptr;
  }
  const std::uint32_t can = (is.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? is.device_caps : is.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) {
    *why = device + " gives no video that is read here";
    return nullptr;
  }
  return driver;
}

std::unique_ptr<V4l2Camera> V4l2Camera::start(std::unique_ptr<CameraDriver> driver, const CameraMode& mode,
                                              const std::string& name, std::string* why) {
  std::unique_ptr<V4l2Camera> camera(new V4l2Camera(std::move(driver)));
  v4l2_format format{};
  *why = set_format(*camera->driver_, mode, name, &format);
  if (!why->empty()) return nullptr;
  camera->format_ = format.fmt.pix.pixelformat;
  camera->width_px_ = format.fmt.pix.width;
  camera->height_px_ = format.fmt.pix.height;
  camera->octets_per_row_ = format.fmt.pix.bytesperline;
  set_rate(*camera->driver_, mode.rate_hz, name);
  *why = camera->begin();
  if (!why->empty()) return nullptr;
  return camera;
}

V4l2Camera::~V4l2Camera() {
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  driver_->control(VIDIOC_STREAMOFF, &type);
}

// Not empty: why it does not begin.
std::string V4l2Camera::begin() {
  constexpr std::uint32_t kBuffers = 3;  // one is read, one is filled, one waits
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int error = driver_->control(VIDIOC_REQBUFS, &request); error != 0) return std::strerror(error);
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer = buffer_of(i);
    if (const int error = driver_->control(VIDIOC_QUERYBUF, &buffer); error != 0) return std::strerror(error);
    buffers_.push_back(driver_->map(buffer.length, buffer.m.offset));
    if (buffers_.back().empty() || !give_back(i)) return "it gives no memory for pictures";
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  const int error = driver_->control(VIDIOC_STREAMON, &type);
  return error == 0 ? std::string() : std::strerror(error);
}

std::optional<V4l2Camera::Filled> V4l2Camera::take(bool* failed) {
  v4l2_buffer buffer = buffer_of(0);
  const int error = driver_->control(VIDIOC_DQBUF, &buffer);
  *failed = error != 0 && error != EAGAIN;
  if (error != 0 || buffer.index >= buffers_.size()) return std::nullopt;
  const std::size_t octets = std::min<std::size_t>(buffer.bytesused, buffers_[buffer.index].size());
  return Filled{buffer.index, octets, (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0};
}

bool V4l2Camera::give_back(std::uint32_t index) {
  v4l2_buffer buffer = buffer_of(index);
  return driver_->control(VIDIOC_QBUF, &buffer) == 0;
}

cv::Mat V4l2Camera::grey_of_buffer(const Filled& filled) {
  const auto octets = buffers_[filled.buffer].first(filled.octets);
  const std::string_view encoding = encoding_of(format_);
  if (filled.damaged) return {};
  if (encoding == kJpeg) return grey_.decode(octets);
  return grey_.decode(RawImage{width_px_, height_px_, encoding, false, octets_per_row_, octets});
}

std::optional<cv::Mat> V4l2Camera::read(const std::atomic<bool>& stopped) {
  constexpr std::chrono::seconds kPatience{10};
  constexpr std::chrono::milliseconds kStep{100};
  const auto until = std::chrono::steady_clock::now() + kPatience;
  std::optional<Filled> newest;
  while (!newest && !stopped && std::chrono::steady_clock::now() < until) {
    if (!driver_->wait(kStep)) continue;
    bool failed = false;
    // An old picture is worth less than none.
    while (const auto next = take(&failed)) {
      if (newest) give_back(newest->buffer);
      newest = next;
    }
    if (failed) return std::nullopt;
  }
  if (!newest) return std::nullopt;
  cv::Mat grey = grey_of_buffer(*newest);
  give_back(newest->buffer);
  return grey;
}

}  // namespace coslam
