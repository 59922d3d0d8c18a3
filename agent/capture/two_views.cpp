// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/two_views.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

namespace coslam {
namespace {

constexpr int kAcross = 320;  // pixels of a half as it is compared
constexpr int kAround = 7;    // of a patch: what is less far from its centre

cv::Mat half_of(const cv::Mat& grey, bool left) {
  const int across = grey.cols / 2, down = std::max(1, grey.rows * kAcross / across);
  cv::Mat half;
  cv::resize(grey(cv::Rect(left ? 0 : grey.cols - across, 0, across, grey.rows)), half, {kAcross, down}, 0, 0,
             cv::INTER_AREA);
  return half;
}

cv::Rect around(cv::Point centre, int by_x, int by_y) {
  return {centre.x - by_x, centre.y - by_y, 2 * by_x + 1, 2 * by_y + 1};
}

// By how much it moved from the left half to where the right one shows the same, near its row.
std::optional<cv::Point> shift_of(const cv::Mat& left, const cv::Mat& right, cv::Point at) {
  constexpr int kOffRow = 6, kAlong = kAcross / 3;
  constexpr double kAlike = 0.85;
  const cv::Rect whole({}, right.size());
  const cv::Rect in = around(at, kAround + kAlong, kAround + kOffRow) & whole;
  cv::Mat likeness;
  cv::matchTemplate(right(in), left(around(at, kAround, kAround)), likeness, cv::TM_CCOEFF_NORMED);
  double best = 0;
  cv::Point found;
  cv::minMaxLoc(likeness, nullptr, &best, nullptr, &found);
  return best > kAlike ? std::optional(found + in.tl() + cv::Point(kAround, kAround) - at) : std::nullopt;
}

int middle(std::vector<int> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, at);
  return *at;
}

// How many of them are about the same: depths differ, rows do not.
std::size_t that_agree(const std::vector<cv::Point>& shifts) {
  constexpr int kAlong = kAcross / 8, kOffRow = 1;
  if (shifts.empty()) return 0;
  std::vector<int> along, down;
  for (const cv::Point& s : shifts) along.push_back(s.x), down.push_back(s.y);
  const cv::Point usual(middle(along), middle(down));
  return static_cast<std::size_t>(std::ranges::count_if(shifts, [&](const cv::Point& s) {
    return std::abs(s.x - usual.x) <= kAlong && std::abs(s.y - usual.y) <= kOffRow;
  }));
}

}  // namespace

bool shows_two_views(const cv::Mat& grey) {
  constexpr int kMost = 100;
  constexpr std::size_t kLeast = 20;
  constexpr double kShare = 0.3;  // of its corners: of stereo pairs 0.45 and more, of single pictures below 0.2
  if (grey.cols < 2 * std::max(grey.rows, kAcross)) return false;
  const cv::Mat left = half_of(grey, true), right = half_of(grey, false);
  const cv::Rect inside(kAround, kAround, left.cols - 2 * kAround, left.rows - 2 * kAround);
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(left, corners, kMost, 0.02, 12);
  std::erase_if(corners, [&](const cv::Point2f& c) { return !inside.contains(cv::Point(c)); });
  std::vector<cv::Point> shifts;
  for (const cv::Point2f& c : corners) {
    if (const auto shift = shift_of(left, right, c)) shifts.push_back(*shift);
  }
  return corners.size() >= kLeast &&
         static_cast<double>(that_agree(shifts)) > kShare * static_cast<double>(corners.size());
}

std::string how_to_split(int width_px) {
  const std::string half = std::to_string(width_px / 2);
  return "make two sources of it, a file by `ffmpeg -i FILE -vf crop=iw/2:ih:0:0 left.mp4` and "
         "`ffmpeg -i FILE -vf crop=iw/2:ih:iw/2:0 right.mp4`, a camera by `videocrop right=" +
         half + "` and `videocrop left=" + half + "` in a `gst:` pipeline each";
}

}  // namespace coslam
