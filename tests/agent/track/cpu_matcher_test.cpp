// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "agent/track/matcher.h"
#include "tests/support/synthetic_view.h"

namespace coslam::cpu_matcher_test {
namespace {

using test::plane_texture;
using test::render;
using test::View;

const cv::Size kImage(320, 240);
const Eigen::Vector2f kShift_px(6.3F, -4.2F);

View shifted(const Eigen::Vector2f& by_px) {
  View v = View::at({400, 300}, 0, 1, kImage);
  v.plane_from_image(0, 2) -= by_px.x();
  v.plane_from_image(1, 2) -= by_px.y();
  return v;
}

const cv::Mat& texture() {
  static const cv::Mat image = plane_texture(800, 600, 5);
  return image;
}

// Two images of a plane that goes by kShift_px, and tracks all over the first.
class CpuMatcherTest : public ::testing::Test {
 protected:
  CpuMatcherTest()
      : first_(render(texture(), shifted({0, 0}), kImage)), second_(render(texture(), shifted(kShift_px), kImage)) {
    matcher_ = cpu_matcher({});
  }
  void push_both() {
    matcher_->push(first_);
    for (int y = 40; y <= 200; y += 40) {
      for (int x = 40; x <= 280; x += 40) add_track({static_cast<float>(x), static_cast<float>(y)});
    }
    matcher_->push(second_);
  }
  // With the image of the track as it is in the newest.
  Sought& add_track(const Eigen::Vector2f& px) {
    auto key = std::make_unique<KeyPatch>();
    key->take(matcher_->newest().level(0), px);
    key->number = static_cast<std::uint32_t>(keys_.size() + 1);
    tracks_.push_back({.from_px = px, .motion_px = {0, 0}, .key = key.get()});
    keys_.push_back(std::move(key));
    return tracks_.back();
  }
  static void expect_near(const Eigen::Vector2f& px, const Eigen::Vector2f& expected, float distance_px) {
    EXPECT_LT((px - expected).norm(), distance_px) << px.transpose() << " for " << expected.transpose();
  }
  void expect_all_found(const Following& following) const {
    ASSERT_EQ(following.sightings.size(), tracks_.size());
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      const TrackSighting& s = following.sightings[i];
      ASSERT_TRUE(s.found) << tracks_[i].from_px.transpose();
      expect_near(s.px, tracks_[i].from_px + kShift_px, 0.1F);
      ASSERT_TRUE(s.key.found);
      expect_near(s.key.px, tracks_[i].from_px + kShift_px, 0.1F);
    }
  }

  const cv::Mat first_, second_;
  std::unique_ptr<Matcher> matcher_;
  std::vector<std::unique_ptr<KeyPatch>> keys_;
  std::vector<Sought> tracks_;
};

TEST_F(CpuMatcherTest, TracksGoWithTheImage) {
  push_both();
  const Following following = matcher_->follow(tracks_, {0, 0});
  expect_near(following.shift_px, kShift_px, 8);
  expect_all_found(following);
}

TEST_F(CpuMatcherTest, AWrongGuessOfTheirMotionIsMadeGood) {
  push_both();
  for (std::size_t i = 0; i < tracks_.size(); i += 3) tracks_[i].motion_px = {-45, 30};
  expect_all_found(matcher_->follow(tracks_, {0, 0}));
}

TEST_F(CpuMatcherTest, WhatIsCoveredIsNotFound) {
  cv::Mat covered = second_.clone();
  const cv::Mat other = render(plane_texture(800, 600, 77), shifted({0, 0}), kImage);
  const cv::Rect part(100, 60, 120, 100);
  other(part).copyTo(covered(part));
  matcher_->push(first_);
  add_track({160 - kShift_px.x(), 110 - kShift_px.y()});
  add_track({40, 200});
  matcher_->push(covered);
  const Following following = matcher_->follow(tracks_, kShift_px);
  EXPECT_FALSE(following.sightings.at(0).found);
  EXPECT_TRUE(following.sightings.at(1).found) << "it is beside what covers the other";
}

TEST_F(CpuMatcherTest, TracksEndAtTheBorder) {
  matcher_->push(first_);
  add_track({320 - 1 - 8 - 3, 120});  // would be 3 px nearer to it than allowed
  add_track({320 - 1 - 8 - 8, 120});
  matcher_->push(second_);
  const Following following = matcher_->follow(tracks_, kShift_px);
  EXPECT_FALSE(following.sightings.at(0).found);
  EXPECT_TRUE(following.sightings.at(1).found);
}

TEST_F(CpuMatcherTest, AnImageAloneHoldsNoOneBack) {
  EXPECT_TRUE(matcher_->newest().empty());
  matcher_->push(first_);
  EXPECT_TRUE(matcher_->before().empty());
  EXPECT_FALSE(matcher_->newest().empty());
  matcher_->push(second_);
  EXPECT_TRUE(matcher_->follow({}, {0, 0}).sightings.empty());
  EXPECT_EQ(*matcher_->before().level(0).at(50, 60), first_.at<std::uint8_t>(60, 50));
  EXPECT_EQ(*matcher_->newest().level(0).at(50, 60), second_.at<std::uint8_t>(60, 50));
}

TEST_F(CpuMatcherTest, AfterARestartImagesMayHaveAnotherSize) {
  push_both();
  matcher_->restart();
  EXPECT_TRUE(matcher_->before().empty());
  EXPECT_TRUE(matcher_->newest().empty());
  tracks_.clear();
  matcher_->push(first_(cv::Rect(0, 0, 200, 160)).clone());
  add_track({100, 80});
  matcher_->push(second_(cv::Rect(0, 0, 200, 160)).clone());
  expect_all_found(matcher_->follow(tracks_, {0, 0}));
}

TEST_F(CpuMatcherTest, CornersAreInTheirCellAndTheStrongestIsLast) {
  matcher_->push(first_);
  const std::vector<CornerCell> cells{{10, 10, 60, 50}, {60, 10, 110, 50}, {100, 60, 101, 61}};
  matcher_->watch(cells);
  for (std::size_t c = 0; c < 2; ++c) {
    const CellCorners found = matcher_->corners(c);
    ASSERT_FALSE(found.corners.empty());
    EXPECT_LE(found.corners.size(), kMostCellCorners);
    EXPECT_TRUE(std::ranges::is_sorted(found.corners, {}, &Corner::score));
    EXPECT_GT(found.corners.front().score, found.mean_score);
    for (const Corner& corner : found.corners) {
      EXPECT_GE(corner.px.x(), static_cast<float>(cells[c].x0) - 0.5F);
      EXPECT_LT(corner.px.x(), static_cast<float>(cells[c].x1));
      EXPECT_GE(corner.px.y(), static_cast<float>(cells[c].y0) - 0.5F);
      EXPECT_LT(corner.px.y(), static_cast<float>(cells[c].y1));
    }
  }
  EXPECT_LE(matcher_->corners(2).corners.size(), 1U);
}

TEST_F(CpuMatcherTest, AnImageOfOneGreyHasNeitherCornersNorTracks) {
  matcher_->push(first_);
  add_track({160, 120});
  matcher_->push(cv::Mat(kImage, CV_8U, cv::Scalar(90)));
  matcher_->watch({{10, 10, 60, 50}});
  EXPECT_TRUE(matcher_->corners(0).corners.empty());
  EXPECT_FALSE(matcher_->follow(tracks_, {0, 0}).sightings.at(0).found);
}

}  // namespace
}  // namespace coslam::cpu_matcher_test
