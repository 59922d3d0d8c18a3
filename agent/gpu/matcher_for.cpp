// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/matcher_for.h"

#include <utility>

#include "agent/gpu/cuda.h"
#include "agent/gpu/match_program.h"
#include "agent/gpu/opencl.h"
#include "common/base/error.h"
#include "common/base/log.h"

namespace coslam {
namespace {

class FallbackMatcher final : public Matcher {
 public:
  FallbackMatcher(DeviceMatcher device, const TrackerConfig& config)
      : config_(config), device_(std::move(device.device)), matcher_(std::move(device.matcher)) {}

  void push(const cv::Mat& grey) override {
    try {
      matcher_->push(grey);
    } catch (const DeviceFailure& failure) {
      go_to_cpu(failure);
    }
  }
  void restart() override {
    cells_.clear();
    try {
      matcher_->restart();
    } catch (const DeviceFailure& failure) {
      go_to_cpu(failure);
      matcher_->restart();
    }
  }
  Following follow(const std::vector<Sought>& tracks, const Eigen::Vector2f& last_shift_px) override {
    try {
      return matcher_->follow(tracks, last_shift_px);
    } catch (const DeviceFailure& failure) {
      go_to_cpu(failure);
      return matcher_->follow(tracks, last_shift_px);
    }
  }
  void watch(const std::vector<CornerCell>& cells) override {
    cells_ = cells;
    try {
      matcher_->watch(cells);
    } catch (const DeviceFailure& failure) {
      go_to_cpu(failure);
    }
  }
  CellCorners corners(std::size_t cell) override {
    try {
      return matcher_->corners(cell);
    } catch (const DeviceFailure& failure) {
      go_to_cpu(failure);
      return matcher_->corners(cell);
    }
  }
  const Pyramid& before() const override { return matcher_->before(); }
  const Pyramid& newest() const override { return matcher_->newest(); }

 private:
  void go_to_cpu(const DeviceFailure& failure) {
    log_warn("tracking goes on on the CPU: " + device_ + ": " + failure.what());
    auto cpu = cpu_matcher(config_);
    if (!before().empty()) cpu->push(before().level(0).image());
    cpu->push(newest().level(0).image());
    cpu->watch(cells_);
    matcher_ = std::move(cpu);
  }

  const TrackerConfig config_;
  const std::string device_;
  std::unique_ptr<Matcher> matcher_;
  std::vector<CornerCell> cells_;
};

}  // namespace

std::vector<std::string> tracker_devices() { return {"auto", "cpu", "opencl", "cuda"}; }

std::unique_ptr<Matcher> with_fallback(DeviceMatcher device, const TrackerConfig& config) {
  return std::make_unique<FallbackMatcher>(std::move(device), config);
}

std::unique_ptr<Matcher> matcher_for(const TrackerConfig& config) {
  if (config.device == "cpu") return cpu_matcher(config);
  const bool any = config.device == "auto";
  std::string why;
  const auto on = [&](const char* name, auto&& device) -> std::unique_ptr<Matcher> {
    if (!any && config.device != name) return nullptr;
    try {
      DeviceMatcher made = device_matcher(device(), config);
      log_info("tracks on " + made.device);
      return with_fallback(std::move(made), config);
    } catch (const DeviceFailure& failure) {
      why = failure.what();
      if (any && dynamic_cast<const NoDevice*>(&failure) == nullptr) {
        log_warn(std::string("a GPU cannot be used: ") + failure.what());
      }
      return nullptr;
    }
  };
  const std::string program = match_program();
  if (auto matcher = on("cuda", [&] { return cuda_device(program); })) return matcher;
  if (auto matcher = on("opencl", [&] { return opencl_device(any, program); })) return matcher;
  if (!any) throw UserError("agent.tracker.device: " + config.device + " cannot be used: " + why);
  return cpu_matcher(config);
}

}  // namespace coslam
