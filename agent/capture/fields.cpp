// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/fields.h"

#include <opencv2/core.hpp>

namespace coslam {

bool is_combed(const cv::Mat& bgr) {
  constexpr int kStep = 8;  // rows; tells enough
  double neighbours = 0, same_field = 0;
  for (int y = 0; y + 2 < bgr.rows; y += kStep) {
    neighbours += cv::norm(bgr.row(y), bgr.row(y + 1), cv::NORM_L1);
    same_field += cv::norm(bgr.row(y), bgr.row(y + 2), cv::NORM_L1);
  }
  return neighbours > same_field;
}

void keep_one_field(cv::Mat& bgr) {
  for (int y = 1; y < bgr.rows; y += 2) {
    cv::Mat row = bgr.row(y);
    if (y + 1 < bgr.rows) {
      cv::addWeighted(bgr.row(y - 1), 0.5, bgr.row(y + 1), 0.5, 0, row);
    } else {
      bgr.row(y - 1).copyTo(row);
    }
  }
}

}  // namespace coslam
