// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/plot/top_view.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "common/base/error.h"
#include "deploy/coslam/plot/projection.h"
#include "tests/support/temp_folder.h"

namespace coslam::plot::top_view_test {
namespace {

// A flat world: wide in x, less in z, nearly nothing in y, which points down.
TopView flat_world() {
  TopView view;
  view.up = {0, -1, 0};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 500; ++i)
    view.points.emplace_back(10 * uniform(random), 0.1 * uniform(random), 4 * uniform(random));
  TopViewPath path{"cam0", {}, {}};
  for (int i = 0; i < 50; ++i) path.estimate.emplace_back(-5 + 0.2 * i, 0, 1);
  path.truth = path.estimate;
  view.paths.push_back(path);
  return view;
}

Eigen::Vector3d normal_of(const Projection& p) {
  return Eigen::Vector3d(p.axes.row(0)).cross(Eigen::Vector3d(p.axes.row(1)));
}

TEST(Projection, ShowsThePlaneOfWidestSpreadFromAbove) {
  const Projection p = widest_plane(flat_world());
  EXPECT_GT(std::abs(p.axes.row(0).dot(Eigen::Vector3d::UnitX())), 0.99);
  EXPECT_GT(std::abs(p.axes.row(1).dot(Eigen::Vector3d::UnitZ())), 0.99);
  // Seen from above: the axes to the right and upwards span a normal along "up".
  EXPECT_LT(normal_of(p).y(), -0.99);
}

TEST(Projection, CamerasThatAgreeTellUp) {
  TopView view = flat_world();
  view.up = Eigen::Vector3d(0.5, -1, 0).normalized();
  EXPECT_LT((normal_of(widest_plane(view)) - view.up).norm(), 1e-9);
  view.up *= 0.5;  // they do not agree: only the side
  EXPECT_LT(normal_of(widest_plane(view)).y(), -0.99);
  view.up = Eigen::Vector3d::UnitX();  // they look down
  EXPECT_GT(std::abs(normal_of(widest_plane(view)).y()), 0.99);
}

TEST(Projection, WildPointsDoNotWidenTheWindow) {
  TopView view = flat_world();
  const Projection calm = widest_plane(view);
  for (int i = 0; i < 5; ++i) view.points.emplace_back(0, 1e5 * i, 1e6);
  const Projection wild = widest_plane(view);
  EXPECT_LT((wild.max - wild.min).norm(), 1.2 * (calm.max - calm.min).norm());
  EXPECT_GT(std::abs(wild.axes.row(0).dot(Eigen::Vector3d::UnitX())), 0.99);
}

TEST(TopViewPicture, HasPointsPathsAndLegend) {
  const test::TempFolder folder;
  const cv::Mat picture = draw_top_view(flat_world(), 800, 600);
  ASSERT_EQ(picture.size(), cv::Size(800, 600));
  cv::Mat blue;
  cv::inRange(picture, cv::Scalar(170, 105, 0), cv::Scalar(190, 120, 20), blue);  // the first path's colour
  EXPECT_GT(cv::countNonZero(blue), 300);
  cv::Mat grey;
  cv::inRange(picture, cv::Scalar(170, 170, 170), cv::Scalar(180, 180, 180), grey);
  EXPECT_GT(cv::countNonZero(grey), 500);
  save_picture(folder / "view.png", picture);
  EXPECT_EQ(cv::imread(folder / "view.png").size(), cv::Size(800, 600));
  EXPECT_THROW(save_picture(folder / "no/such/view.png", picture), UserError);
}

TEST(TopViewPicture, EmptyAndPointlikeWorldsAreDrawn) {
  EXPECT_FALSE(draw_top_view({}).empty());
  TopView still;
  still.paths.push_back({"cam0", Positions(10, Eigen::Vector3d(1, 2, 3)), {}});
  EXPECT_FALSE(draw_top_view(still).empty());
}

TEST(TopView, ShowsWhatMoves) {
  const auto orange = [](const cv::Mat& picture) {
    int n = 0;
    for (const cv::Vec3b& px : cv::Mat_<cv::Vec3b>(picture)) n += px[0] < 100 && px[2] > 230 ? 1 : 0;
    return n;
  };
  TopView view = flat_world();
  EXPECT_EQ(orange(draw_top_view(view)), 0);
  for (int i = 0; i < 40; ++i) view.moving.emplace_back(0.1 * i, 0, 2);
  EXPECT_GT(orange(draw_top_view(view)), 40);
}

}  // namespace
}  // namespace coslam::plot::top_view_test
