// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "agent/track/tracker.h"

namespace coslam::patch_test {
namespace {

// grey = 20 + x / 4 + y / 8, which scaling and interpolation reproduce exactly.
cv::Mat ramp(int cols, int rows) {
  cv::Mat image(rows, cols, CV_8U);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < cols; ++x)
      image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(20 + x / 4.0 + y / 8.0);
  }
  return image;
}

Track track_at(double x, double y) { return {TrackId(5), Eigen::Vector2d(x, y).cast<float>(), 3}; }

int grey_at(const ImagePatch& patch, int dx, int dy) {
  constexpr int kHalf = kPatchSide / 2;
  return patch.grey.at(static_cast<std::size_t>((dy + kHalf) * kPatchSide + dx + kHalf));
}

TEST(Patch, IsCentredOnTheTrueSubPixelPlace) {
  // 752 is no multiple of ten: rounding the size of the small image must not move its content.
  for (const int cols : {640, 752}) {
    const cv::Mat small = shrink_for_patches(ramp(cols, 480));
    EXPECT_NEAR(small.cols, cols * 0.3, 1);
    for (const double x : {60.0, 301.4, 555.75}) {
      for (const double y : {80.0, 233.3, 400.9}) {
        const ImagePatch patch = cut_patch(small, track_at(x, y));
        EXPECT_EQ(patch.track, TrackId(5));
        for (const int d : {-5, 0, 5}) {
          const double step = d / 0.3;  // pixels of the image a pixel of the patch
          EXPECT_NEAR(grey_at(patch, d, 0), 20 + (x + step) / 4 + y / 8, 1.1) << cols << " " << x << " " << y;
          EXPECT_NEAR(grey_at(patch, 0, d), 20 + x / 4 + (y + step) / 8, 1.1) << cols << " " << x << " " << y;
        }
      }
    }
  }
}

TEST(Patch, RepeatsTheBorder) {
  const cv::Mat small = shrink_for_patches(ramp(640, 480));
  const ImagePatch corner = cut_patch(small, track_at(0, 0));
  EXPECT_EQ(grey_at(corner, -5, -5), small.at<std::uint8_t>(0, 0));
  EXPECT_EQ(grey_at(corner, -5, -5), grey_at(corner, -1, -1));
  const ImagePatch other = cut_patch(small, track_at(639, 479));
  EXPECT_EQ(grey_at(other, 5, 5), small.at<std::uint8_t>(small.rows - 1, small.cols - 1));
}

}  // namespace
}  // namespace coslam::patch_test
