// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/partners.h"

#include <algorithm>

#include "server/estimator/solve/appearance.h"

namespace coslam {
namespace {

constexpr std::size_t kFew = 12;  // images
constexpr std::size_t kMost = 6;  // others, for each of more

}  // namespace

Partners::Partners(const std::vector<FeatureImage>& images) : n_(images.size()), are_(n_ * n_, n_ <= kFew) {
  if (n_ <= kFew) return;
  AppearanceIndex index;
  for (const FeatureImage& image : images) index.add(image.descriptors);
  for (std::size_t i = 0; i < n_; ++i) {
    const std::vector<int> votes = index.votes(images[i].descriptors);
    std::vector<std::pair<int, std::size_t>> order;
    for (std::size_t j = 0; j < n_; ++j) {
      if (j == i) continue;
      if (votes[j] > 0) order.emplace_back(-votes[j], j);
      if (by_rig(images[i], images[j])) set(i, j);
    }
    std::ranges::sort(order);
    for (std::size_t k = 0; k < std::min(kMost, order.size()); ++k) set(i, order[k].second);
  }
}

std::vector<std::pair<int, int>> Partners::pairs() const {
  std::vector<std::pair<int, int>> out;
  for (int a = 0; a < static_cast<int>(n_); ++a) {
    for (int b = a + 1; b < static_cast<int>(n_); ++b) {
      if (are(a, b)) out.emplace_back(a, b);
    }
  }
  return out;
}

}  // namespace coslam
