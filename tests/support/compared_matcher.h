// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "agent/track/matcher.h"

namespace coslam::test {

// How far apart two matchers say that the same tracks and corners are. What only one of them found is very far.
struct Agreement {
  std::vector<float> distances_px, corner_distances_px;  // of the tracks; pixels of the level
  static constexpr float kFar = 1e6F;

  void add(const Following& one, const Following& other) {
    for (std::size_t i = 0; i < one.sightings.size(); ++i) {
      const TrackSighting &a = one.sightings[i], &b = other.sightings[i];
      if (!a.found && !b.found) continue;
      float distance = a.found != b.found || a.key.found != b.key.found ? kFar : (a.px - b.px).norm();
      if (a.found && a.key.found && b.key.found) distance = std::max(distance, (a.key.px - b.key.px).norm());
      distances_px.push_back(distance);
    }
  }
  void add(const CellCorners& one, const CellCorners& other) {
    for (std::size_t i = 0; i < std::max(one.corners.size(), other.corners.size()); ++i) {
      const bool both = i < one.corners.size() && i < other.corners.size();
      corner_distances_px.push_back(both ? (one.corners[i].px - other.corners[i].px).norm() : kFar);
    }
  }
};

inline float quantile(std::vector<float> values, double part) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

// Answers as the first matcher does and asks the other the same, so that each image is compared from equal starts.
class ComparedMatcher final : public Matcher {
 public:
  ComparedMatcher(std::unique_ptr<Matcher> first, std::unique_ptr<Matcher> other, Agreement* agreement)
      : first_(std::move(first)), other_(std::move(other)), agreement_(agreement) {}

  void push(const cv::Mat& grey) override {
    first_->push(grey);
    other_->push(grey);
  }
  void restart() override {
    first_->restart();
    other_->restart();
  }
  Following follow(const std::vector<Sought>& tracks, const Eigen::Vector2f& last_shift_px) override {
    Following following = first_->follow(tracks, last_shift_px);
    agreement_->add(following, other_->follow(tracks, last_shift_px));
    return following;
  }
  void watch(const std::vector<CornerCell>& cells) override {
    first_->watch(cells);
    other_->watch(cells);
  }
  CellCorners corners(std::size_t cell) override {
    CellCorners found = first_->corners(cell);
    agreement_->add(found, other_->corners(cell));
    return found;
  }
  const Pyramid& before() const override { return first_->before(); }
  const Pyramid& newest() const override { return first_->newest(); }

 private:
  std::unique_ptr<Matcher> first_, other_;
  Agreement* agreement_;
};

}  // namespace coslam::test
