// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "server/estimator/solve/start.h"

namespace coslam {

// Selects which images of a start are compared: all of up to a dozen; of more, each only with the few that look most
// like it and with those of its rig, so that the number of pairs does not grow with the square.
class Partners {
 public:
  explicit Partners(const std::vector<FeatureImage>& images);
  bool are(int a, int b) const { return are_[static_cast<std::size_t>(a) * n_ + static_cast<std::size_t>(b)]; }
  // Returns each pair once, in ascending order.
  std::vector<std::pair<int, int>> pairs() const;

 private:
  void set(std::size_t a, std::size_t b) { are_[a * n_ + b] = are_[b * n_ + a] = true; }

  std::size_t n_;
  std::vector<bool> are_;
};

}  // namespace coslam
