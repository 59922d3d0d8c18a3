// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/model/track_frame.h"

namespace coslam {

using Descriptors = Eigen::Matrix<float, Eigen::Dynamic, kDescriptorBytes, Eigen::RowMajor>;

// Converts SIFT descriptors of kDescriptorBytes each to unit vectors, one per row, whose distances compare histograms
// (Arandjelovic and Zisserman, "Three things everyone should know", 2012). Squared distance of two: 2 - 2 a.b.
inline Descriptors root_sift(const std::vector<std::uint8_t>& bytes) {
  const auto rows = static_cast<Eigen::Index>(bytes.size()) / kDescriptorBytes;
  Descriptors out = Eigen::Map<const Eigen::Matrix<std::uint8_t, Eigen::Dynamic, kDescriptorBytes, Eigen::RowMajor>>(
                        bytes.data(), rows, kDescriptorBytes)
                        .cast<float>();
  for (Eigen::Index r = 0; r < rows; ++r) out.row(r) = (out.row(r) / (out.row(r).sum() + 1e-6F)).cwiseSqrt();
  return out;
}

}  // namespace coslam
