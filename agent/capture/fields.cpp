// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/fields.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

namespace coslam {
namespace {

constexpr double kRowsApart_px = 0.5;  // of a field, by which odd rows lie below even ones

// Every second row, as floats.
cv::Mat field_of(const cv::Mat& grey, int first_row) {
  cv::Mat field(grey.rows / 2, grey.cols, CV_32F);
  for (int y = 0; y < field.rows; ++y) {
    cv::Mat row = field.row(y);
    grey.row(2 * y + first_row).convertTo(row, CV_32F);
  }
  return field;
}

struct Rows {
  cv::Mat even, odd;
};

Rows rows_of(const cv::Mat& grey) { return {field_of(grey, 0), field_of(grey, 1)}; }

struct Moved {
  cv::Rect tile;
  cv::Point2d by_px;
};

// How far each tile of a field moves to another. phaseCorrelate() writes to what it compares.
std::vector<Moved> motion(const cv::Mat& from, const cv::Mat& to) {
  constexpr int kColumns = 7, kRows = 5, kLeastWidth = 64, kLeastHeight = 32;
  const cv::Size tile(std::max(kLeastWidth, from.cols / kColumns), std::max(kLeastHeight, from.rows / kRows));
  cv::Mat window;
  cv::createHanningWindow(window, tile, CV_32F);
  std::vector<Moved> out;
  for (int y = 0; y + tile.height <= from.rows; y += tile.height) {
    for (int x = 0; x + tile.width <= from.cols; x += tile.width) {
      const cv::Rect at({x, y}, tile);
      out.push_back({at, cv::phaseCorrelate(from(at).clone(), to(at).clone(), window)});
    }
  }
  return out;
}

// By how much the odd rows of a tile differ from the even ones, moved by so much.
double difference(const Rows& rows, const cv::Rect& tile, const cv::Point2d& moved_px) {
  const cv::Point2d middle(tile.x + 0.5 * (tile.width - 1), tile.y + 0.5 * (tile.height - 1));
  cv::Mat even;
  cv::getRectSubPix(rows.even, tile.size(), middle - moved_px + cv::Point2d(0, kRowsApart_px), even);
  return cv::norm(even, rows.odd(tile), cv::NORM_L1);
}

// It changes by more than neighbouring pixels differ: by a pixel or more, which is not noise alone.
bool has_moved(const cv::Mat& from, const cv::Mat& to) {
  constexpr int kStep = 16;  // rows
  constexpr double kMore = 1.2;
  double change = 0, step = 0;
  for (int y = 0; y < to.rows; y += kStep) {
    change += cv::norm(from.row(y), to.row(y), cv::NORM_L1);
    step += cv::norm(to.row(y).colRange(1, to.cols), to.row(y).colRange(0, to.cols - 1), cv::NORM_L1);
  }
  return change > kMore * step;
}

}  // namespace

Fields FieldOrder::note(const cv::Mat& grey) {
  constexpr int kEnough = 3, kEnoughForNone = 8, kMostMeasured = 60;
  if (order_ != Fields::kUnknown || grey.empty()) return order_;
  const Fields voted = vote(grey);
  last_ = grey;
  if (voted != Fields::kUnknown) {
    votes_ = voted == std::exchange(voted_, voted) ? votes_ + 1 : 1;
    if (votes_ >= (voted == Fields::kNone ? kEnoughForNone : kEnough)) order_ = voted;
  }
  if (order_ == Fields::kUnknown && measured_ >= kMostMeasured) order_ = Fields::kNone;
  if (order_ != Fields::kUnknown) last_.release();
  return order_;
}

// By what fits best between the rows of both images: no way, half the way from the one to the other, or half of it
// back.
Fields FieldOrder::vote(const cv::Mat& grey) {
  constexpr double kLeast_px = 1.5, kBetter = 0.9;
  constexpr int kLeastTiles = 6;
  if (last_.size() != grey.size() || grey.cols < 2 || !has_moved(last_, grey)) return Fields::kUnknown;
  ++measured_;
  const Rows before = rows_of(last_), now = rows_of(grey);
  double none = 0, ahead = 0, back = 0;
  int tiles = 0;
  for (const auto& [tile, way_px] : motion(before.even, now.even)) {
    if (cv::norm(way_px) < kLeast_px) continue;
    ++tiles;
    for (const Rows* rows : {&before, &now}) {
      none += difference(*rows, tile, {});
      ahead += difference(*rows, tile, 0.5 * way_px);
      back += difference(*rows, tile, -0.5 * way_px);
    }
  }
  if (tiles < kLeastTiles) return Fields::kUnknown;
  if (none < kBetter * std::min(ahead, back)) return Fields::kNone;
  if (ahead < kBetter * std::min(none, back)) return Fields::kUpperFirst;
  return back < kBetter * std::min(none, ahead) ? Fields::kLowerFirst : Fields::kUnknown;
}

void keep_first_field(cv::Mat& image, Fields order) {
  for (int y = order == Fields::kUpperFirst ? 1 : 0; y < image.rows; y += 2) {
    const int above = y > 0 ? y - 1 : y + 1, below = y + 1 < image.rows ? y + 1 : y - 1;
    if (std::min(above, below) < 0 || std::max(above, below) >= image.rows) return;  // it is one row
    cv::Mat row = image.row(y);
    cv::addWeighted(image.row(above), 0.5, image.row(below), 0.5, 0, row);
  }
}

}  // namespace coslam
