// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

// Images of a textured plane under known homographies: every pixel's place is known. Places on the plane are in plane
// pixels: pixels of an image that sees it at zoom 1.
namespace coslam::test {

// Textures are this much finer than images, so that sampling them linearly adds no error of its own.
constexpr int kTexelsPerPx = 2;

// Random grey texture: smooth noise of several sizes, and (as in buildings) patches with sharp outlines.
inline cv::Mat plane_texture(int cols, int rows, std::uint64_t seed, bool outlines = true) {
  cv::RNG rng(seed);
  const cv::Size size(cols * kTexelsPerPx, rows * kTexelsPerPx);
  cv::Mat sum(size, CV_32F, cv::Scalar(128));
  for (int i = 0; outlines && i < cols * rows / 3000; ++i) {
    const float y = rng.uniform(0.0F, 1.0F), x = rng.uniform(0.0F, 1.0F);
    const cv::Point2f centre(x * size.width, y * size.height);
    const float high = rng.uniform(10.0F, 90.0F), wide = rng.uniform(10.0F, 90.0F);
    const cv::Size2f sides(wide * kTexelsPerPx, high * kTexelsPerPx);
    std::vector<cv::Point2f> corners(4);
    cv::RotatedRect(centre, sides, rng.uniform(0.0F, 90.0F)).points(corners.data());
    const std::vector<cv::Point> outline(corners.begin(), corners.end());
    cv::fillConvexPoly(sum, outline, cv::Scalar(rng.uniform(50, 206)));
  }
  for (const double cell_px : {3.0, 8.0, 24.0}) {
    cv::Mat noise(static_cast<int>(rows / cell_px) + 2, static_cast<int>(cols / cell_px) + 2, CV_32F);
    rng.fill(noise, cv::RNG::NORMAL, 0, outlines ? 8 : 20);
    cv::resize(noise, noise, size, 0, 0, cv::INTER_CUBIC);
    sum += noise;
  }
  cv::GaussianBlur(sum, sum, cv::Size(), 1.0 * kTexelsPerPx);  // no camera sees sharper than its pixels
  cv::Mat texture;
  sum.convertTo(texture, CV_8U);
  return texture;
}

// How a camera sees the plane.
struct View {
  cv::Matx33d plane_from_image = cv::Matx33d::eye();
  double gain = 1;
  double offset = 0;
  double noise = 0;  // standard deviation, grey levels

  // Looks at plane_px with the image's centre, about which it is turned by angle_rad and zoomed.
  static View at(const cv::Point2d& plane_px, double angle_rad, double zoom, const cv::Size& image) {
    const double c = std::cos(angle_rad) / zoom, s = std::sin(angle_rad) / zoom;
    const double u = 0.5 * (image.width - 1), v = 0.5 * (image.height - 1);
    View view;
    view.plane_from_image = cv::Matx33d(c, -s, plane_px.x - c * u + s * v, s, c, plane_px.y - s * u - c * v, 0, 0, 1);
    return view;
  }

  Eigen::Vector2d plane_px(const Eigen::Vector2d& image_px) const { return map(plane_from_image, image_px); }
  Eigen::Vector2d image_px(const Eigen::Vector2d& plane_px) const { return map(plane_from_image.inv(), plane_px); }

 private:
  static Eigen::Vector2d map(const cv::Matx33d& h, const Eigen::Vector2d& p) {
    const cv::Vec3d q = h * cv::Vec3d(p.x(), p.y(), 1);
    return {q[0] / q[2], q[1] / q[2]};
  }
};

// On a closed path over a texture of 1400 x 1100 pixels, at this angle of it: moves so far to either side, turns, zooms
// and changes its exposure.
inline View view_on_loop(double angle_rad, const cv::Point2d& reach_px, double turn_rad, double log_zoom,
                         const cv::Size& image) {
  const cv::Point2d at(700 + reach_px.x * std::cos(angle_rad), 550 + reach_px.y * std::sin(2 * angle_rad));
  View view = View::at(at, turn_rad * std::sin(angle_rad), std::exp(log_zoom * std::cos(3 * angle_rad)), image);
  view.gain = 1 + 0.1 * std::sin(2 * angle_rad);
  view.noise = 2;
  return view;
}

// The image of the view; beyond the texture it is mirrored.
inline cv::Mat render(const cv::Mat& texture, const View& view, const cv::Size& size, std::uint64_t noise_seed = 1) {
  const cv::Matx33d texel_from_plane(kTexelsPerPx, 0, 0, 0, kTexelsPerPx, 0, 0, 0, 1);
  cv::Mat image;
  cv::warpPerspective(texture, image, texel_from_plane * view.plane_from_image, size,
                      cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REFLECT_101);
  image.convertTo(image, CV_32F, view.gain, view.offset);
  if (view.noise > 0) {
    cv::RNG rng(noise_seed);
    cv::Mat noise(size, CV_32F);
    rng.fill(noise, cv::RNG::NORMAL, 0, view.noise);
    image += noise;
  }
  image.convertTo(image, CV_8U);
  return image;
}

}  // namespace coslam::test
