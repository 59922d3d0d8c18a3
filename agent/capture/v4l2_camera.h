// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "agent/capture/camera_mode.h"
#include "agent/capture/decode.h"

namespace coslam {

// The driver of a camera, by Video4Linux.
class CameraDriver {
 public:
  // Null: there is none; why, as the end of a sentence.
  static std::unique_ptr<CameraDriver> open(const std::string& device, std::string* why);
  virtual ~CameraDriver() = default;
  // Does what ioctl() does; 0, or the number of the error.
  virtual int control(unsigned long request, void* argument) = 0;
  // Memory of one of its buffers, for as long as the driver lives; empty: it gives none.
  virtual std::span<const std::uint8_t> map(std::size_t octets, std::int64_t offset) = 0;
  // Waits until a picture is there; false: none came within that time.
  virtual bool wait(std::chrono::milliseconds most) = 0;
};

// A camera of this machine that takes pictures. For one thread.
class V4l2Camera {
 public:
  // Starts a camera in a mode; what the mode leaves open stays as it is set. Null: it gives no pictures that are read
  // here; why, as the end of a sentence. Throws UserError, named `name`, for a mode that it does not have.
  static std::unique_ptr<V4l2Camera> start(std::unique_ptr<CameraDriver> driver, const CameraMode& mode,
                                           const std::string& name, std::string* why);
  ~V4l2Camera();
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  // The newest picture, CV_8UC1, empty where it is damaged; nothing: none came for 10 s, the camera has failed, or
  // `stopped` was set.
  std::optional<cv::Mat> read(const std::atomic<bool>& stopped);

 private:
  explicit V4l2Camera(std::unique_ptr<CameraDriver> driver) : driver_(std::move(driver)) {}
  std::string begin();
  // A picture that the driver has filled; nothing: none is there. failed: there will be no more.
  struct Filled {
    std::uint32_t buffer = 0;
    std::size_t octets = 0;
    bool damaged = false;
  };
  std::optional<Filled> take(bool* failed);
  bool give_back(std::uint32_t buffer);
  cv::Mat grey_of_buffer(const Filled& filled);

  std::unique_ptr<CameraDriver> driver_;
  std::vector<std::span<const std::uint8_t>> buffers_;
  std::uint32_t format_ = 0, width_px_ = 0, height_px_ = 0, octets_per_row_ = 0;
  GreyReader grey_;
};

}  // namespace coslam
