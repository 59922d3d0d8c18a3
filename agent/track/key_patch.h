// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "agent/track/pyramid.h"
#include "agent/track/samples.h"

namespace coslam {

// First appearance of a track. Following from image to image adds up small errors and slides along edges and outlines
// unnoticed; finding this patch again, under an affine warp, does neither.
struct KeyPatch {
  using Vector7f = Eigen::Matrix<float, 7, 1>;  // shift x y, affine xu xv yu yv, gain

  std::uint32_t number = 0;  // changes each time that the tracker takes a patch
  Samples grey{}, dx{}, dy{};
  float squares = 0;  // sum of squares of grey, mean taken out
  Vector7f totals = Vector7f::Zero();
  Eigen::Matrix<float, 7, 7> inverse = Eigen::Matrix<float, 7, 7>::Zero();  // inverse of the damped normal matrix
  Eigen::Matrix2f warp = Eigen::Matrix2f::Identity();  // maps the patch to the image where it was last found

  void take(const PyramidLevel& level, const Eigen::Vector2f& centre_px);
};

struct KeyAlignment {
  bool found = false;
  Eigen::Vector2f px = Eigen::Vector2f::Zero();
  Eigen::Matrix2f warp = Eigen::Matrix2f::Identity();
  float zncc = 0.0f;
};

// Inverse-compositional Gauss-Newton over shift, affine warp, gain and offset, from guess_px and the patch's last warp.
// The warp is damped: it changes little from one image to the next.
KeyAlignment find_key_patch(const KeyPatch& patch, const Pyramid& pyramid, const Eigen::Vector2f& guess_px);

}  // namespace coslam
