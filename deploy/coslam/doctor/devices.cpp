// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "deploy/coslam/doctor/camera.h"

namespace coslam::doctor {
namespace {

// The largest picture of a format, "WxH"; empty: the driver does not say.
std::string largest(int device, std::uint32_t format) {
  std::uint32_t width = 0, height = 0;
  v4l2_frmsizeenum size{};
  size.pixel_format = format;
  for (; ioctl(device, VIDIOC_ENUM_FRAMESIZES, &size) == 0; ++size.index) {
    const bool listed = size.type == V4L2_FRMSIZE_TYPE_DISCRETE;
    const std::uint32_t w = listed ? size.discrete.width : size.stepwise.max_width;
    const std::uint32_t h = listed ? size.discrete.height : size.stepwise.max_height;
    if (w * h <= width * height) continue;
    width = w;
    height = h;
  }
  return width == 0 ? std::string() : std::to_string(width) + "x" + std::to_string(height);
}

std::vector<std::string> modes_of(int device) {
  std::vector<std::string> modes;
  v4l2_fmtdesc format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; ioctl(device, VIDIOC_ENUM_FMT, &format) == 0; ++format.index) {
    std::string mode;
    for (unsigned shift = 0; shift < 32; shift += 8)
      mode.push_back(static_cast<char>(format.pixelformat >> shift & 255U));
    const std::string size = largest(device, format.pixelformat);
    if (!size.empty()) mode.append(" up to ").append(size);
    modes.push_back(mode);
  }
  return modes;
}

VideoDevice look_at(const std::string& path) {
  VideoDevice out{.path = path};
  const int device = open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (device < 0) {
    out.forbidden = errno == EACCES || errno == EPERM;
    out.problem = std::generic_category().message(errno);
    return out;
  }
  v4l2_capability is{};
  if (ioctl(device, VIDIOC_QUERYCAP, &is) == 0) {
    out.name = reinterpret_cast<const char*>(is.card);
    out.modes = modes_of(device);
  } else {
    out.problem = "it is no camera";
  }
  close(device);
  return out;
}

}  // namespace

std::vector<VideoDevice> look_at_devices() {
  std::vector<std::string> paths;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", ignored)) {
    if (entry.path().filename().string().starts_with("video")) paths.push_back(entry.path().string());
  }
  std::ranges::sort(paths);
  std::vector<VideoDevice> out(paths.size());
  std::ranges::transform(paths, out.begin(), look_at);
  return out;
}

}  // namespace coslam::doctor
