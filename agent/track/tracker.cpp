// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/tracker.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "common/base/check.h"

namespace coslam {

struct Tracker::State {
  TrackerConfig config;
  cv::Mat previous;
  std::vector<Track> tracks;
  std::vector<Eigen::Vector2f> velocity;
  std::uint32_t next_id = 1;

  void follow(const cv::Mat& grey);
  void replenish(const cv::Mat& grey);
};

void Tracker::State::follow(const cv::Mat& grey) {
  if (tracks.empty()) return;
  const cv::Size window(16, 16);
  std::vector<cv::Point2f> from, guess, back;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    from.emplace_back(tracks[i].raw_px.x(), tracks[i].raw_px.y());
    guess.emplace_back(from.back().x + velocity[i].x(), from.back().y + velocity[i].y());
  }
  back = from;
  std::vector<unsigned char> ok, ok_back;
  std::vector<float> error;
  const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.02);
  cv::calcOpticalFlowPyrLK(previous, grey, from, guess, ok, error, window, config.levels - 1, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  cv::calcOpticalFlowPyrLK(grey, previous, guess, back, ok_back, error, window, 1, stop, cv::OPTFLOW_USE_INITIAL_FLOW);
  std::size_t kept = 0;
  const float border = static_cast<float>(config.border_px);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const bool inside = guess[i].x >= border && guess[i].y >= border &&
                        guess[i].x <= static_cast<float>(grey.cols - 1) - border &&
                        guess[i].y <= static_cast<float>(grey.rows - 1) - border;
    if (!inside || ok[i] == 0 || ok_back[i] == 0 || cv::norm(back[i] - from[i]) > config.forward_backward_px) continue;
    const Eigen::Vector2f now(guess[i].x, guess[i].y);
    velocity[kept] = now - tracks[i].raw_px;
    tracks[kept++] = {tracks[i].id, now, tracks[i].age_frames + 1};
  }
  tracks.resize(kept);
  velocity.resize(kept);
}

void Tracker::State::replenish(const cv::Mat& grey) {
  const int missing = config.max_tracks - static_cast<int>(tracks.size());
  if (missing <= 0) return;
  const double distance = config.min_distance_px * grey.cols / 640.0;
  cv::Mat mask(grey.size(), CV_8U, cv::Scalar(0));
  const int border = static_cast<int>(config.border_px) + 1;
  mask(cv::Rect(border, border, grey.cols - 2 * border, grey.rows - 2 * border)).setTo(255);
  for (const Track& t : tracks) {
    cv::circle(mask, cv::Point2f(t.raw_px.x(), t.raw_px.y()), static_cast<int>(distance), cv::Scalar(0), -1);
  }
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(grey, corners, missing, config.min_eigenvalue, distance, mask);
  for (const cv::Point2f& c : corners) {
    tracks.push_back({TrackId(next_id++), {c.x, c.y}, 0});
    velocity.emplace_back(0, 0);
  }
}

Tracker::Tracker(const TrackerConfig& config) : state_(std::make_unique<State>()) { state_->config = config; }
Tracker::~Tracker() = default;

const std::vector<Track>& Tracker::step(const cv::Mat& grey) {
  COSLAM_CHECK(grey.type() == CV_8UC1, "a grey 8-bit image");
  state_->follow(grey);
  state_->replenish(grey);
  grey.copyTo(state_->previous);
  return state_->tracks;
}

void Tracker::reset() {
  state_->tracks.clear();
  state_->velocity.clear();
}

}  // namespace coslam
