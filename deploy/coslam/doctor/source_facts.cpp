// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <opencv2/imgproc.hpp>

#include "agent/agent.h"
#include "agent/capture/camera_of.h"
#include "agent/capture/sources.h"
#include "agent/feed.h"
#include "agent/track/working_scale.h"
#include "common/base/error.h"
#include "common/dataset/calibration.h"
#include "common/dataset/live_topic.h"
#include "common/flow/clock.h"
#include "deploy/coslam/doctor/camera.h"

namespace coslam::doctor {
namespace {

using Clock = std::chrono::steady_clock;

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// How much of what an image shows is fine detail: the variance of its Laplacian to its own. Noise counts as detail.
// At the width at which most are tracked: wide ones hold less at their finest by nature.
double sharpness_of(const cv::Mat& image) {
  constexpr int kWidth = 640;
  const cv::Mat grey = scaled_image(image, std::min(1.0, static_cast<double>(kWidth) / image.cols));
  cv::Mat laplacian;
  cv::Laplacian(grey, laplacian, CV_32F);
  cv::Scalar mean, spread, of_all;
  cv::meanStdDev(laplacian, mean, spread);
  cv::meanStdDev(grey, mean, of_all);
  return of_all[0] > 0 ? spread[0] * spread[0] / (of_all[0] * of_all[0]) : 0;
}

double clipped_share(const cv::Mat& grey) {
  return static_cast<double>(cv::countNonZero(grey < 5) + cv::countNonZero(grey > 250)) /
         static_cast<double>(grey.total());
}

class Look {
 public:
  Look(const AgentOptions& settings, SourceFacts& facts) : facts_(facts) {
    auto [found, images] = open_camera(settings.source, settings.calibration, settings.play);
    facts.doubt = found.guess;
    facts.width_px = found.camera.width_px;
    facts.height_px = found.camera.height_px;
    facts.most_tracks = settings.agent.tracker.max_tracks;
    tracker_ = make_feature_tracker(found.camera, settings.agent);
    feed_ = facts.live ? real_time_feed(std::move(images), 1, utc_now_ns()) : prefetching_feed(std::move(images));
  }

  void run(std::chrono::milliseconds most) {
    std::atomic<bool> stop{false};
    const Instant start = Clock::now();
    while (Clock::now() - start < most) {
      const auto image = feed_->next(stop);
      if (!image) break;
      take(*image);
    }
    facts_.dropped = static_cast<int>(feed_->dropped());
    sum_up();
  }

 private:
  void take(const Image& image) {
    ++facts_.images;
    if (last_ns_) intervals_s_.push_back(to_seconds(image.capture_ns - *last_ns_));
    last_ns_ = image.capture_ns;
    behind_s_.push_back(to_seconds(utc_now_ns() - image.capture_ns));
    if (!image.grey.empty()) {
      light_.push_back(cv::mean(image.grey)[0]);
      clipped_.push_back(clipped_share(image.grey));
      sharpness_.push_back(sharpness_of(image.grey));
    }
    if (image.fault != ImageFault::kNone && image.fault != ImageFault::kAlternating) {
      ++facts_.at_fault;
      ++faults_.at(static_cast<std::size_t>(image.fault));
      return;
    }
    const Instant before = Clock::now();
    facts_.tracks = static_cast<int>(tracker_->step(image).size());
    took_s_.push_back(std::chrono::duration<double>(Clock::now() - before).count());
  }

  void sum_up() {
    facts_.fault = static_cast<ImageFault>(std::ranges::max_element(faults_) - faults_.begin());
    facts_.period_s = median(intervals_s_) / (1 + facts_.dropped / std::max(1.0, static_cast<double>(facts_.images)));
    if (!intervals_s_.empty()) facts_.longest_s = *std::ranges::max_element(intervals_s_);
    facts_.behind_s = facts_.live ? median(behind_s_) : 0;
    facts_.light = median(light_);
    facts_.clipped = median(clipped_);
    facts_.sharpness = median(sharpness_);
    facts_.track_s = median(took_s_);
  }

  SourceFacts& facts_;
  std::unique_ptr<FeatureTracker> tracker_;
  std::unique_ptr<Feed> feed_;
  std::optional<TimeNs> last_ns_;
  std::vector<double> intervals_s_, behind_s_, light_, clipped_, sharpness_, took_s_;
  std::array<int, kImageFaults> faults_{};
};

// Empty: it can be read, or nodes say it, who are asked with the source.
std::string problem_of_calibration(const std::string& calibration) {
  if (calibration.empty() || calibration.starts_with(kRos2Scheme)) return {};
  try {
    read_calibration(calibration);
  } catch (const UserError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

SourceFacts look_at_source(const AgentOptions& settings, std::chrono::milliseconds most) {
  SourceFacts facts{.name = settings.source, .live = is_live_uri(settings.source), .nominal_hz = settings.play.rate_hz};
  facts.calibration_problem = problem_of_calibration(settings.calibration);
  AgentOptions readable = settings;
  if (!facts.calibration_problem.empty()) readable.calibration.clear();
  try {
    Look(readable, facts).run(most);
  } catch (const UserError& error) {
    facts.problem = error.what();
  }
  return facts;
}

}  // namespace coslam::doctor
