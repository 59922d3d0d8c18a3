// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <opencv2/core.hpp>
#include <utility>

#include "agent/capture/sources.h"

namespace coslam {
namespace {

// What a sensor gives without light. The same frame gives the same noise.
void darken(Image& image) {
  constexpr double kBlackLevel = 6, kNoise = 2.5;  // grey values
  cv::RNG random(0x5eedU + image.frame.value);
  random.fill(image.grey, cv::RNG::NORMAL, kBlackLevel, kNoise);
  image.color.release();
}

// Something lies on the lens at times.
class CoveredSource final : public ImageSource {
 public:
  CoveredSource(std::unique_ptr<ImageSource> source, std::vector<TimeSpan> covered)
      : source_(std::move(source)), covered_(std::move(covered)) {}

  std::optional<Image> next() override {
    auto image = source_->next();
    if (!image) return image;
    if (!first_ns_) first_ns_ = source_->live() ? image->capture_ns : 0;
    const double t_s = to_seconds(image->capture_ns - *first_ns_);
    const auto covers = [&](const TimeSpan& span) { return t_s >= span.from_s && t_s < span.to_s; };
    if (std::any_of(covered_.begin(), covered_.end(), covers)) darken(*image);
    return image;
  }
  bool skip() override { return source_->skip(); }
  std::optional<TimeNs> peek_ns() const override { return source_->peek_ns(); }
  std::filesystem::path peek_file() const override { return source_->peek_file(); }
  std::optional<int> about_left() const override { return source_->about_left(); }
  bool live() const override { return source_->live(); }
  std::size_t undated() const override { return source_->undated(); }
  void stop() override { source_->stop(); }

 private:
  std::unique_ptr<ImageSource> source_;
  std::vector<TimeSpan> covered_;
  std::optional<TimeNs> first_ns_;  // a live source counts from its first image
};

}  // namespace

std::unique_ptr<ImageSource> covered_at_times(std::unique_ptr<ImageSource> source, std::vector<TimeSpan> covered) {
  return std::make_unique<CoveredSource>(std::move(source), std::move(covered));
}

}  // namespace coslam
