// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/matching.h"

#include <algorithm>
#include <opencv2/core.hpp>

#include "server/estimator/solve/root_sift.h"

namespace coslam {
namespace {

struct Best {
  int index = -1;
  float first = 2, second = 2;  // squared distances
};

void offer(Best* b, int index, float distance) {
  if (distance < b->first) {
    b->second = b->first;
    b->first = distance;
    b->index = index;
  } else {
    b->second = std::min(b->second, distance);
  }
}

}  // namespace

std::vector<FeatureMatch> match_descriptors(const std::vector<std::uint8_t>& first,
                                            const std::vector<std::uint8_t>& second) {
  if (first.empty() || second.empty()) return {};
  Descriptors of_first = root_sift(first), of_second = root_sift(second);
  const auto matrix_of = [](Descriptors& d) {
    return cv::Mat(static_cast<int>(d.rows()), kDescriptorBytes, CV_32F, d.data());
  };
  const cv::Mat a = matrix_of(of_first), b = matrix_of(of_second);
  const cv::Mat similarity = a * b.t();  // of unit vectors: squared distance = 2 - 2 s
  std::vector<Best> of_a(static_cast<std::size_t>(a.rows)), of_b(static_cast<std::size_t>(b.rows));
  for (int i = 0; i < a.rows; ++i) {
    const float* s = similarity.ptr<float>(i);
    for (int j = 0; j < b.rows; ++j) {
      const float d2 = 2 - 2 * s[j];
      offer(&of_a[static_cast<std::size_t>(i)], j, d2);
      offer(&of_b[static_cast<std::size_t>(j)], i, d2);
    }
  }
  std::vector<FeatureMatch> matches;
  const auto distinct = [](const Best& b_) { return b_.first < kDistinctRatio * kDistinctRatio * b_.second; };
  for (int i = 0; i < a.rows; ++i) {
    const Best& best = of_a[static_cast<std::size_t>(i)];
    if (best.index < 0 || !distinct(best)) continue;
    const Best& back = of_b[static_cast<std::size_t>(best.index)];
    if (back.index == i && distinct(back)) matches.push_back({i, best.index, best.first});
  }
  return matches;
}

}  // namespace coslam
