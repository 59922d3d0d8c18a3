// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <optional>
#include <utility>

#include "agent/track/align.h"
#include "agent/track/match_limits.h"
#include "agent/track/matcher.h"
#include "agent/track/motion.h"

namespace coslam {
namespace {

class CpuMatcher final : public Matcher {
 public:
  explicit CpuMatcher(const TrackerConfig& config) : config_(config) {}

  void push(const cv::Mat& grey) override {
    std::swap(before_, newest_);
    newest_.build(grey, config_.levels);
  }

  void restart() override {
    before_ = newest_ = {};
    cells_.clear();
  }

  Following follow(const std::vector<Sought>& tracks, const Eigen::Vector2f& last_shift_px) override {
    Following out;
    out.shift_px = global_shift(before_, newest_);
    const Eigen::Vector2f change = out.shift_px - last_shift_px;
    std::vector<std::optional<Eigen::Vector2f>> matches;
    MotionField field;
    for (const Sought& t : tracks) {
      // A turn of the camera changes all motions alike; parallax stays with the track.
      const std::array<Eigen::Vector2f, 3> guesses = {t.from_px + t.motion_px, t.from_px + t.motion_px + change,
                                                      t.from_px + out.shift_px};
      const Guess guess = best_guess(before_, t.from_px, newest_, guesses);
      matches.push_back(match(t, guess.px, guess.top));
      if (matches.back()) field.add(t.from_px, *matches.back() - t.from_px);
    }
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      const Sought& t = tracks[i];
      if (!matches[i] && !field.empty()) matches[i] = match(t, t.from_px + field.near(t.from_px), kRetryTop);
      TrackSighting& s = out.sightings.emplace_back();
      if (!matches[i]) continue;
      s = {true, *matches[i], find_key_patch(*t.key, newest_, *matches[i])};
    }
    return out;
  }

  void watch(const std::vector<CornerCell>& cells) override { cells_ = cells; }

  CellCorners corners(std::size_t cell) override {
    return corners_in(cells_[cell], newest_.level(corner_level(newest_.levels())), score_);
  }

  const Pyramid& before() const override { return before_; }
  const Pyramid& newest() const override { return newest_; }

 private:
  bool inside(const Eigen::Vector2f& px) const {
    const float border = static_cast<float>(config_.border_px);
    const PyramidLevel& image = newest_.level(0);
    return px.x() >= border && px.y() >= border && px.x() <= static_cast<float>(image.cols() - 1) - border &&
           px.y() <= static_cast<float>(image.rows() - 1) - border;
  }

  // From the image before to the newest, from level `top` down, and back.
  std::optional<Eigen::Vector2f> match(const Sought& t, const Eigen::Vector2f& guess_px, int top) const {
    const WindowAlignment forward = align(before_, t.from_px, newest_, guess_px, top);
    if (!forward.found || !inside(forward.px) || forward.zncc < (t.moving ? kMovingZncc : 1.0) * config_.min_zncc)
      return std::nullopt;
    const WindowAlignment back = align(newest_, forward.px, before_, t.from_px, kBackwardTop);
    if (!back.found ||
        (back.px - t.from_px).norm() > (t.moving ? kMovingForwardBackward : 1.0) * config_.forward_backward_px)
      return std::nullopt;
    return forward.px;
  }

  const TrackerConfig config_;
  Pyramid before_, newest_;
  std::vector<CornerCell> cells_;
  CornerScore score_;
};

}  // namespace

std::unique_ptr<Matcher> cpu_matcher(const TrackerConfig& config) { return std::make_unique<CpuMatcher>(config); }

}  // namespace coslam
