// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/key_patch.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_view.h"

namespace coslam::key_patch_test {
namespace {

const cv::Size kImage(320, 240);
const Eigen::Vector2f kCentre(159.5F, 119.5F);  // fixed by the views below

Pyramid seen(const cv::Mat& texture, double angle_rad, double zoom, double gain = 1) {
  test::View view = test::View::at({400, 300}, angle_rad, zoom, kImage);
  view.gain = gain;
  Pyramid p;
  p.build(test::render(texture, view, kImage), 4);
  return p;
}

// As the tracker does: image after image, from a guess that is a little wrong.
KeyAlignment follow(KeyPatch& patch, const cv::Mat& texture, double angle_rad, double zoom) {
  KeyAlignment a;
  constexpr int kImages = 40;
  for (int i = 1; i <= kImages; ++i) {
    const double s = static_cast<double>(i) / kImages;
    const Pyramid p = seen(texture, angle_rad * s, std::pow(zoom, s), 1 - 0.2 * s);
    a = find_key_patch(patch, p, kCentre + Eigen::Vector2f(0.2F, -0.15F));
    if (!a.found) break;
    patch.warp = a.warp;
  }
  return a;
}

class KeyPatchWarp : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(KeyPatchWarp, IsFoundWhereItIs) {
  const auto [angle_rad, zoom] = GetParam();
  const cv::Mat texture = test::plane_texture(800, 600, 7, false);
  KeyPatch patch;
  patch.take(seen(texture, 0, 1).level(0), kCentre);
  const KeyAlignment a = follow(patch, texture, angle_rad, zoom);
  ASSERT_TRUE(a.found);
  EXPECT_LT((a.px - kCentre).norm(), zoom < 1.5 ? 0.05 : 0.15);  // from the halved image when it is that close
  EXPECT_GT(a.zncc, 0.95);
  Eigen::Matrix2f truth;
  truth << std::cos(angle_rad), std::sin(angle_rad), -std::sin(angle_rad), std::cos(angle_rad);
  truth *= static_cast<float>(zoom);
  EXPECT_LT((a.warp - truth).norm(), 0.06) << a.warp;
}

INSTANTIATE_TEST_SUITE_P(Views, KeyPatchWarp,
                         testing::Values(std::pair(0.0, 1.0), std::pair(0.8, 1.0), std::pair(-1.5, 1.0),
                                         std::pair(0.0, 1.3), std::pair(0.0, 1.9), std::pair(0.3, 0.75)));

TEST(KeyPatch, ElsewhereItCorrelatesLittle) {
  const cv::Mat texture = test::plane_texture(800, 600, 8);
  const Pyramid p = seen(texture, 0, 1);
  KeyPatch patch;
  patch.take(p.level(0), kCentre);
  const KeyAlignment a = find_key_patch(patch, p, kCentre + Eigen::Vector2f(40, 25));
  EXPECT_TRUE(!a.found || a.zncc < 0.7) << a.zncc;
}

}  // namespace
}  // namespace coslam::key_patch_test
