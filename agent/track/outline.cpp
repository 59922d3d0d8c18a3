// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/outline.h"

#include "agent/track/motion.h"

namespace coslam {
namespace {

constexpr float kOutline = 4.0f;          // twice, squared
constexpr float kApart_px = 0.7f;         // between the two motions; less says nothing
constexpr int kLeastComparisons = 3;      // images
constexpr float kComparisonsKept = 0.9f;  // from image to image

}  // namespace

bool OutlineEvidence::add(const PyramidLevel& before, const PyramidLevel& now, const Eigen::Vector2f& px,
                          const Eigen::Vector2f& motion_px, const Eigen::Vector2f& rest_motion_px) {
  if ((motion_px - rest_motion_px).squaredNorm() < kApart_px * kApart_px) return false;
  track_difference_ *= kComparisonsKept;
  rest_difference_ *= kComparisonsKept;
  track_difference_ += difference_of_middles(before, px - motion_px, now, px);
  rest_difference_ += difference_of_middles(before, px - rest_motion_px, now, px);
  return ++comparisons_ >= kLeastComparisons && rest_difference_ < kOutline * track_difference_;
}

}  // namespace coslam
