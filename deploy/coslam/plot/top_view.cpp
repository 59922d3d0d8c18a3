// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/plot/top_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "common/base/error.h"
#include "common/image/image_file.h"
#include "deploy/coslam/plot/projection.h"

namespace coslam::plot {
namespace {

const cv::Scalar kInk(40, 40, 40), kPoint(175, 175, 175), kMoving(60, 150, 255), kTruth(0, 0, 0);
// Told apart by people with colour blindness too (Okabe and Ito), blue green red.
const std::array<cv::Scalar, 7> kColours = {
    cv::Scalar(178, 114, 0), cv::Scalar(0, 94, 213),   cv::Scalar(115, 158, 0), cv::Scalar(167, 121, 204),
    cv::Scalar(0, 159, 230), cv::Scalar(233, 180, 86), cv::Scalar(66, 228, 240)};
constexpr int kMargin_px = 60;
constexpr int kLegendRow_px = 26;
constexpr int kShift = 4;  // sub-pixel bits of OpenCV's drawing functions

class Canvas {
 public:
  // The drawing keeps below the first top_px rows.
  Canvas(const Projection& projection, int width_px, int height_px, int top_px)
      : image_(height_px, width_px, CV_8UC3, cv::Scalar::all(255)), projection_(projection) {
    const Eigen::Vector2d size = (projection.max - projection.min).cwiseMax(1e-9);
    px_per_unit_ = std::min((width_px - 2 * kMargin_px) / size.x(), (height_px - top_px - kMargin_px) / size.y());
    middle_ = 0.5 * (projection.min + projection.max);
    middle_px_ = {0.5 * width_px, 0.5 * (height_px + top_px - kMargin_px)};
  }

  double px_per_unit() const { return px_per_unit_; }
  cv::Mat& image() { return image_; }

  void point(const Eigen::Vector3d& p, const cv::Scalar& colour) {
    const Eigen::Vector2d at = pixel(p);
    if (!inside(at)) return;
    cv::circle(image_, fixed(at), (3 << kShift) / 2, colour, cv::FILLED, cv::LINE_AA, kShift);
  }

  // dash_px = 0: a full line.
  void line(const Positions& positions, const cv::Scalar& colour, int thickness, double dash_px) {
    double drawn_px = 0;
    for (std::size_t i = 1; i < positions.size(); ++i) {
      const Eigen::Vector2d a = pixel(positions[i - 1]), b = pixel(positions[i]);
      const bool gap = dash_px > 0 && std::fmod(drawn_px, 2 * dash_px) >= dash_px;
      drawn_px += (b - a).norm();
      if (!gap) cv::line(image_, fixed(a), fixed(b), colour, thickness, cv::LINE_AA, kShift);
    }
  }

  void start_mark(const Positions& positions, const cv::Scalar& colour) {
    if (!positions.empty()) {
      cv::circle(image_, fixed(pixel(positions.front())), 6 << kShift, colour, cv::FILLED, cv::LINE_AA, kShift);
    }
  }

  void text(const std::string& words, cv::Point at, double size) {
    cv::putText(image_, words, at, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
  }

 private:
  Eigen::Vector2d pixel(const Eigen::Vector3d& p) const {
    const Eigen::Vector2d d = px_per_unit_ * (projection_(p) - middle_);
    return {middle_px_.x() + d.x(), middle_px_.y() - d.y()};
  }
  bool inside(const Eigen::Vector2d& p) const {
    return p.x() >= 0 && p.y() >= 0 && p.x() < image_.cols && p.y() < image_.rows;
  }
  static cv::Point fixed(const Eigen::Vector2d& p) {
    constexpr double kFar = 1 << 20;  // OpenCV clips, but its integers are 32 bits
    return {static_cast<int>(std::clamp(p.x(), -kFar, kFar) * (1 << kShift)),
            static_cast<int>(std::clamp(p.y(), -kFar, kFar) * (1 << kShift))};
  }

  cv::Mat image_;
  Projection projection_;
  double px_per_unit_ = 1;
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();  // of the window, in the plane and in the picture
  Eigen::Vector2d middle_px_ = Eigen::Vector2d::Zero();
};

// Largest of 1, 2, 5 times a power of ten that is not above the length.
double round_length(double length) {
  const double power = std::pow(10, std::floor(std::log10(length)));
  for (const double digit : {5.0, 2.0}) {
    if (digit * power <= length) return digit * power;
  }
  return power;
}

void draw_scale_bar(Canvas& canvas, const std::string& unit) {
  constexpr double kLongest_px = 220;
  const double length = round_length(kLongest_px / canvas.px_per_unit());
  const int right = canvas.image().cols - 30, y = canvas.image().rows - 30;
  const int left = right - static_cast<int>(std::lround(length * canvas.px_per_unit()));
  cv::line(canvas.image(), {left, y}, {right, y}, kInk, 2, cv::LINE_AA);
  for (const int x : {left, right}) cv::line(canvas.image(), {x, y - 5}, {x, y + 5}, kInk, 2, cv::LINE_AA);
  char label[64];
  std::snprintf(label, sizeof label, "%g %s", length, unit.c_str());
  canvas.text(label, {left, y - 12}, 0.55);
}

void draw_legend(Canvas& canvas, const TopView& view) {
  int y = 30;
  canvas.text(view.title, {20, y}, 0.7);
  bool any_truth = false;
  for (std::size_t i = 0; i < view.paths.size(); ++i) {
    y += kLegendRow_px;
    cv::line(canvas.image(), {20, y - 5}, {60, y - 5}, kColours[i % kColours.size()], 3, cv::LINE_AA);
    canvas.text(view.paths[i].label, {70, y}, 0.5);
    any_truth = any_truth || !view.paths[i].truth.empty();
  }
  if (!view.moving.empty()) {
    y += kLegendRow_px;
    for (int x = 24; x < 60; x += 12) cv::circle(canvas.image(), {x, y - 5}, 2, kMoving, cv::FILLED, cv::LINE_AA);
    canvas.text("what moves", {70, y}, 0.5);
  }
  if (!any_truth) return;
  y += kLegendRow_px;
  for (int x = 20; x < 60; x += 12) cv::line(canvas.image(), {x, y - 5}, {x + 6, y - 5}, kTruth, 1, cv::LINE_AA);
  canvas.text("truth", {70, y}, 0.5);
}

}  // namespace

cv::Mat draw_top_view(const TopView& view, int width_px, int height_px) {
  const int legend_px = kLegendRow_px * static_cast<int>(view.paths.size() + 4);
  Canvas canvas(widest_plane(view), width_px, height_px, std::min(legend_px, height_px / 3));
  for (const Eigen::Vector3d& point : view.points) canvas.point(point, kPoint);
  for (const Eigen::Vector3d& point : view.moving) canvas.point(point, kMoving);
  for (std::size_t i = 0; i < view.paths.size(); ++i) {
    const cv::Scalar& colour = kColours[i % kColours.size()];
    canvas.line(view.paths[i].estimate, colour, 3, 0);
    canvas.start_mark(view.paths[i].estimate, colour);
  }
  constexpr double kDash_px = 6;
  for (const TopViewPath& path : view.paths) canvas.line(path.truth, kTruth, 1, kDash_px);
  draw_legend(canvas, view);
  draw_scale_bar(canvas, view.unit);
  return canvas.image();
}

void save_picture(const std::filesystem::path& file, const cv::Mat& picture) {
  if (!write_image_file(file, picture)) throw UserError(file.string() + ": cannot be written");
}

}  // namespace coslam::plot
