// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/moving.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "common/base/error.h"
#include "deploy/coslam/eval/statistics.h"
#include "tests/support/temp_folder.h"

namespace coslam::eval::moving_test {
namespace {

using ::testing::HasSubstr;

TEST(Masks, NonZeroMovesExceptNearOutlines) {
  const test::TempFolder folder;
  std::filesystem::create_directories(folder / "cam0");
  cv::Mat mask(40, 60, CV_8UC1, cv::Scalar(0));
  mask(cv::Rect(30, 0, 30, 40)) = 1;
  cv::imwrite(folder / "cam0/000010.png", mask);
  Masks masks(folder.path());
  EXPECT_EQ(masks.moving_at("cam0", FrameId(10), {45, 20}), true);
  EXPECT_EQ(masks.moving_at("cam0", FrameId(10), {59, 39}), true);  // in the corner of the image
  EXPECT_EQ(masks.moving_at("cam0", FrameId(10), {10, 20}), false);
  EXPECT_EQ(masks.moving_at("cam0", FrameId(10), {31, 20}), std::nullopt);
  EXPECT_EQ(masks.moving_at("cam0", FrameId(10), {28, 20}), std::nullopt);
  EXPECT_EQ(masks.moving_at("cam0", FrameId(10), {70, 20}), std::nullopt);
  EXPECT_EQ(masks.moving_at("cam0", FrameId(11), {45, 20}), std::nullopt);  // no mask for the frame
  EXPECT_EQ(masks.moving_at("cam1", FrameId(10), {45, 20}), std::nullopt);
}

TEST(Classification, PrecisionAndRecall) {
  Classification c;
  EXPECT_EQ(c.precision(), std::nullopt);
  EXPECT_EQ(c.recall(), std::nullopt);
  for (int i = 0; i < 6; ++i) c.add(true, PointState::kDynamic);
  for (int i = 0; i < 2; ++i) c.add(false, PointState::kDynamic);
  c.add(true, PointState::kStatic);
  c.add(true, std::nullopt);
  for (int i = 0; i < 49; ++i) c.add(false, PointState::kStatic);
  c.add(false, std::nullopt);
  EXPECT_DOUBLE_EQ(*c.precision(), 0.75);
  EXPECT_DOUBLE_EQ(*c.recall(), 0.75);
  EXPECT_DOUBLE_EQ(*c.static_on_moving(), 0.125);
  EXPECT_DOUBLE_EQ(*c.false_alarm(), 2 / 52.0);
  EXPECT_EQ(c.observations(), 60);
}

TEST(TrackAges, CountFromTheFirstRow) {
  TrackAges ages;
  const auto age = [&](std::uint32_t frame, std::uint32_t track) {
    ResultTrackRow row;
    row.frame = FrameId(frame);
    row.track = TrackId(track);
    return ages.age(row);
  };
  EXPECT_EQ(age(20, 1), 0U);
  EXPECT_EQ(age(20, 2), 0U);
  EXPECT_EQ(age(30, 1), 10U);
  EXPECT_EQ(age(50, 1), 30U);
  EXPECT_EQ(age(40, 3), 0U);
}

TEST(MedianLength, OfPathsWithTwoSamples) {
  std::unordered_map<PointId, PointPath> paths;
  EXPECT_EQ(median_length_s(paths), std::nullopt);
  paths[PointId(1)] = {{0, {}}};
  EXPECT_EQ(median_length_s(paths), std::nullopt);
  paths[PointId(2)] = {{0, {}}, {500'000'000, {}}, {1'000'000'000, {}}};
  paths[PointId(3)] = {{0, {}}, {3'000'000'000, {}}};
  EXPECT_DOUBLE_EQ(*median_length_s(paths), 2);
}

TEST(TruthPoints, ReadsAndNamesBadLines) {
  const test::TempFolder folder;
  const auto file = folder.write("p.csv", "t_s,id,x,y,z\n0.1,hand,1,2,3\n0.0,hand,0,2,3\n0.0,9,5,5,5\n");
  const auto points = read_truth_points(file);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points.at("hand")[0].t_ns, 0);
  EXPECT_EQ(position_at(points.at("hand"), 50'000'000, 200'000'000), Eigen::Vector3d(0.5, 2, 3));
  EXPECT_EQ(position_at(points.at("hand"), 50'000'000, 50'000'000), std::nullopt);
  EXPECT_EQ(position_at(points.at("hand"), 150'000'000, 200'000'000), std::nullopt);
  folder.write("p.csv", "0.1,hand,1,2,3\n0.1,hand,1,2\n");
  EXPECT_THAT(test::error_of<UserError>([&] { read_truth_points(file); }), HasSubstr("p.csv:2: not a line"));
}

TEST(DynamicErrors, FollowTheNearestMarkedPoint) {
  std::map<std::string, PointPath> truth;
  std::unordered_map<PointId, PointPath> estimate;
  const auto at = [](int i) { return i * 100'000'000LL; };
  for (int i = 0; i < 10; ++i) {
    truth["a"].push_back({at(i), {0.1 * i, 0, 0}});
    truth["b"].push_back({at(i), {0.1 * i, 1, 0}});
    estimate[PointId(1)].push_back({at(i), {0.05 * i, 0.51, 0}});  // follows b in a map of half the size, 2 cm off
    estimate[PointId(2)].push_back({at(i), {0.05 * i, 0.25, 0}});  // half a metre from both
    estimate[PointId(3)].push_back({at(i + 100), {0, 0, 0}});      // at another time
  }
  const auto errors = dynamic_errors(estimate, truth, {2, Eigen::Quaterniond::Identity(), {0, 0, 0}});
  EXPECT_EQ(errors.paths, 1);
  EXPECT_EQ(errors.unmatched_paths, 2);
  ASSERT_EQ(errors.errors_m.size(), 10u);
  EXPECT_NEAR(percentile(errors.errors_m, 50), 0.02, 1e-12);
}

}  // namespace
}  // namespace coslam::eval::moving_test
