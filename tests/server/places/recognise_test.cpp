// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/places/recognise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace coslam {
namespace {

class HasReliefTest : public testing::Test {
 protected:
  void add(const Eigen::Vector3d& position, double sigma = 0.001) {
    MapPoint p;
    p.position = position;
    p.covariance = sigma * sigma * Eigen::Matrix3d::Identity();
    points_.push_back(p);
  }
  void add_poster() {
    for (int i = 0; i < 60; ++i) add({0.03 * i, 0.5 * std::sin(i), 3 + 0.02 * i + 0.01 * std::cos(7 * i)});
  }
  bool relief() const {
    std::vector<const MapPoint*> points;
    for (const MapPoint& p : points_) points.push_back(&p);
    return has_relief(points, 3);
  }
  std::vector<MapPoint> points_;
};

TEST_F(HasReliefTest, NothingHasNone) { EXPECT_FALSE(relief()); }

TEST_F(HasReliefTest, APosterHasNone) {
  add_poster();
  EXPECT_FALSE(relief());
}

TEST_F(HasReliefTest, SomethingBeforeThePosterIs) {
  add_poster();
  for (int i = 0; i < 10; ++i) add({0.09 * i, 0.5 * std::cos(i), 2.2 + 0.02 * i});
  EXPECT_TRUE(relief());
}

TEST_F(HasReliefTest, PointsOfUncertainDepthTellNothing) {
  add_poster();
  for (int i = 0; i < 20; ++i) add({0.09 * i, 0.5 * std::cos(i), 2.2 + 0.02 * i}, 0.5);
  EXPECT_FALSE(relief());
}

}  // namespace
}  // namespace coslam
