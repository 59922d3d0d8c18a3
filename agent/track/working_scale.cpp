// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/working_scale.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "agent/track/align.h"
#include "agent/track/match_limits.h"
#include "agent/track/pyramid.h"
#include "agent/track/window.h"

namespace coslam {
namespace {

constexpr int kSmall_px = 480;  // wide: windows would show too much of the scene in images no larger
// Detail that halving loses. Between the two the scale stays as it is.
constexpr double kLittleLoss = 1.25, kMuchLoss = 1.32;
constexpr int kFirst = 5;                         // comparisons, one an image, before the first decision
constexpr int kOneIn = 30;                        // images later
constexpr double kNewest = 0.2;                   // weight of the newest comparison
constexpr std::size_t kMost = 100, kFewest = 20;  // places compared
constexpr double kAllLost = 4;                    // whatever is beyond
constexpr double kWorthIt = 0.8;                  // of the finest scale: a smaller one than that
constexpr double kClearlySmaller = 0.71;          // of the finest scale: half its pixels

// Two images at one size.
struct ImagePair {
  Pyramid before, newest;

  ImagePair(const cv::Mat& a, const cv::Mat& b) {
    before.build(a, 1);
    newest.build(b, 1);
  }

  // Standard deviation of where the window is found, up to a factor that is the same for all windows; infinite where
  // it is not found. Pixels.
  double uncertainty_px(const Eigen::Vector2f& from_px, const Eigen::Vector2f& to_px) const {
    constexpr double kUnknown = std::numeric_limits<double>::infinity();
    if (!window_readable(before.level(0), from_px)) return kUnknown;
    WindowTemplate window;
    cut_template(before.level(0), from_px, window);
    if (window.min_eigenvalue < kLeastTexture) return kUnknown;
    const WindowAlignment found = align(before, from_px, newest, to_px, 0);
    if (!found.found || found.zncc <= 0) return kUnknown;
    return std::sqrt(window.squares * std::max(0.0F, 1 - found.zncc * found.zncc) / window.min_eigenvalue);
  }
};

// Video coders copy what stands still from the image before, bit by bit: that tells nothing of noise.
bool is_copied(const cv::Mat& before, const cv::Mat& newest, const MovedPlace& place) {
  constexpr int kHalf = kWindowSide / 2;
  if ((place.to_px - place.from_px).norm() > 0.5F) return false;
  const cv::Point at(cvRound(place.from_px.x()), cvRound(place.from_px.y()));
  const cv::Rect window = cv::Rect(at.x - kHalf, at.y - kHalf, kWindowSide, kWindowSide) & cv::Rect({}, before.size());
  return cv::norm(before(window), newest(window), cv::NORM_L1) == 0;
}

}  // namespace

Eigen::Vector2f scaled_px(const Eigen::Vector2f& px, double scale) {
  return ((px.array() + 0.5F) * static_cast<float>(scale) - 0.5F).matrix();
}

cv::Mat scaled_image(const cv::Mat& grey, double scale) {
  if (scale == 1) return grey;
  // Averaging areas that are not whole pixels takes thirty times as long as interpolating, which sees every pixel down
  // to a scale of a half.
  const int method = scale > 1 ? cv::INTER_CUBIC : scale > 0.5 ? cv::INTER_LINEAR : cv::INTER_AREA;
  cv::Mat out;
  cv::resize(grey, out, {}, scale, scale, method);
  return out;
}

cv::Mat image_of_size(const cv::Mat& grey, const cv::Size& size) {
  cv::Mat out;
  cv::resize(grey, out, size, 0, 0, cv::INTER_LINEAR);
  return out;
}

std::optional<double> loss_by_halving(const cv::Mat& before, const cv::Mat& newest,
                                      std::span<const MovedPlace> places) {
  const ImagePair whole(before, newest), half(scaled_image(before, 0.5), scaled_image(newest, 0.5));
  const std::size_t every = (places.size() + kMost - 1) / kMost;
  std::vector<double> losses;
  for (std::size_t i = 0; i < places.size(); i += every) {
    const MovedPlace& p = places[i];
    if (is_copied(before, newest, p)) continue;
    const double in_whole = whole.uncertainty_px(p.from_px, p.to_px);
    const double in_half = 2 * half.uncertainty_px(scaled_px(p.from_px, 0.5), scaled_px(p.to_px, 0.5));
    if (std::isinf(in_whole) && std::isinf(in_half)) continue;
    losses.push_back(in_half / std::max(in_whole, 1e-6));
  }
  if (losses.size() < kFewest) return std::nullopt;
  const auto middle = losses.begin() + std::ssize(losses) / 2;
  std::ranges::nth_element(losses, middle);
  return std::min(*middle, kAllLost);
}

WorkingScale::WorkingScale(int width_px, const TrackerConfig& config)
    : finest_(width_px <= kSmall_px ? 2 : std::min(1.0, static_cast<double>(config.most_width_px) / width_px)),
      coarse_(finest_) {
  // A small image that is doubled holds no more detail than it came with.
  if (finest_ > 1) return;
  // Whole numbers of pixels are averaged fast.
  int pixels = 2;
  while (1.0 / pixels > kClearlySmaller * finest_) ++pixels;
  const double coarse = std::max(1.0 / pixels, static_cast<double>(kSmall_px) / width_px);
  if (coarse < kWorthIt * finest_) coarse_ = coarse;
}

bool WorkingScale::due() {
  if (coarse_ == finest_) return false;
  const bool first = comparisons_ < kFirst && images_ < kOneIn;
  return ++images_ % kOneIn == 0 || first;
}

void WorkingScale::compared(double loss) {
  ++comparisons_;
  loss_ += (loss - loss_) * std::max(kNewest, 1.0 / comparisons_);
  if (comparisons_ < kFirst) return;
  if (loss_ < kLittleLoss) coarse_is_enough_ = true;
  if (loss_ > kMuchLoss) coarse_is_enough_ = false;
}

}  // namespace coslam
