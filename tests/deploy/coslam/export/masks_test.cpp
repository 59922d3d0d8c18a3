// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/masks.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::exporting::masks_test {
namespace {

// A pinhole of 640 x 480 px at the origin; what is black has been found to move.
class Masks : public ::testing::Test {
 protected:
  Masks() {
    model_.cameras.push_back({{.name = "a"}, {640, 480, 400, 400, 320, 240, DistortionModel::kNone, {}}, {}});
    model_.images.push_back({.camera = 0, .frame = FrameId(0), .t_ns = 1'000'000'000, .name = "a/1.png"});
  }

  struct Seen {
    TimeNs t_ns;
    std::uint32_t point;
    Eigen::Vector3d position;
    std::uint32_t object = 0;  // 0: none
  };
  void moving(const std::vector<Seen>& seen) const {
    DynamicWriter points(result_.dynamic());
    ObjectWriter objects(result_.objects());
    for (const Seen& s : seen) points.write({s.t_ns, PointId(s.point), s.position, Eigen::Matrix3d::Identity(), 2});
    for (std::size_t i = 0; i < seen.size();) {
      std::vector<PointId> members;
      std::size_t k = i;
      for (; k < seen.size() && seen[k].object == seen[i].object && seen[k].t_ns == seen[i].t_ns; ++k)
        members.push_back(PointId(seen[k].point));
      if (seen[i].object != 0)
        objects.write({seen[i].t_ns, ObjectId(seen[i].object), {0, 0, 2}, {0, 0, 0}, {1, 1, 1}, members});
      i = k;
    }
    points.close();
    objects.close();
  }
  cv::Mat mask() {
    EXPECT_TRUE(write_masks(result_, model_, out_));
    return cv::imread((out_ / "a/1.png.png").string(), cv::IMREAD_UNCHANGED);
  }
  static bool black(const cv::Mat& mask, int x, int y) { return mask.at<std::uint8_t>(y, x) == 0; }
  bool all_white() {
    const cv::Mat m = mask();
    return cv::countNonZero(m) == static_cast<int>(m.total());
  }

  test::TempFolder temp_;
  ResultFolder result_{temp_ / "result"};
  std::filesystem::path out_ = temp_ / "masks";
  ColmapModel model_;
};

constexpr TimeNs kNow_ns = 1'000'000'000;

TEST_F(Masks, WhereNothingMovesNoneAreWritten) {
  EXPECT_FALSE(write_masks(result_, model_, out_));
  moving({});
  EXPECT_FALSE(write_masks(result_, model_, out_));
  EXPECT_FALSE(std::filesystem::exists(out_));
}

TEST_F(Masks, APointByItselfIsASpotRoundIt) {
  moving({{kNow_ns, 1, {0.5, 0, 2}}});  // at 420, 240
  const cv::Mat m = mask();
  ASSERT_EQ(m.size(), cv::Size(640, 480));
  EXPECT_TRUE(black(m, 420, 240));
  EXPECT_TRUE(black(m, 420 + 15, 240));
  EXPECT_FALSE(black(m, 420 + 25, 240));
  EXPECT_FALSE(black(m, 420, 240 - 25));
}

TEST_F(Masks, PointsOfOneObjectAreOneArea) {
  const std::vector<Eigen::Vector3d> corners{{-0.5, -0.5, 2}, {0.5, -0.5, 2}, {0.5, 0.5, 2}, {-0.5, 0.5, 2}};
  std::vector<Seen> apart, together;
  for (std::uint32_t i = 0; i < 4; ++i) {
    apart.push_back({kNow_ns, i + 1, corners[i]});
    together.push_back({kNow_ns, i + 1, corners[i], 7});
  }
  moving(apart);
  const cv::Mat spots = mask();
  EXPECT_TRUE(black(spots, 220, 140));
  EXPECT_FALSE(black(spots, 320, 240)) << "between them";
  moving(together);
  const cv::Mat area = mask();
  EXPECT_TRUE(black(area, 320, 240));
  EXPECT_TRUE(black(area, 220 - 15, 240)) << "an outline is farther out than its corners";
  EXPECT_FALSE(black(area, 220 - 30, 240));
}

TEST_F(Masks, TheNearestInstantCountsIfItIsNear) {
  moving({{kNow_ns - 20'000'000, 1, {0.5, 0, 2}}, {kNow_ns + 30'000'000, 1, {-0.5, 0, 2}}});
  const cv::Mat m = mask();
  EXPECT_TRUE(black(m, 420, 240));
  EXPECT_FALSE(black(m, 220, 240));
  model_.images[0].t_ns = kNow_ns + 20'000'000;
  EXPECT_TRUE(black(mask(), 220, 240));
  for (const TimeNs far_ns : {kNow_ns - 80'000'000, kNow_ns + 90'000'000}) {
    model_.images[0].t_ns = far_ns;
    EXPECT_TRUE(all_white()) << far_ns;
  }
}

TEST_F(Masks, WhatIsBehindOrFarBesideTheImageDarkensNothing) {
  moving({{kNow_ns, 1, {0.5, 0, -2}}, {kNow_ns, 2, {50, 0, 2}}, {kNow_ns, 3, {0, 0, 0}}});
  EXPECT_TRUE(all_white());
}

TEST_F(Masks, AnObjectThatReachesIntoTheImageIsSeenThere) {
  moving({{kNow_ns, 1, {-2, -0.3, 2}, 3}, {kNow_ns, 2, {-2, 0.3, 2}, 3}, {kNow_ns, 3, {-1, 0, 2}, 3}});
  const cv::Mat m = mask();
  EXPECT_TRUE(black(m, 60, 240)) << "two of its corners are left of the image";
  EXPECT_FALSE(black(m, 320, 240));
}

TEST_F(Masks, EveryImageHasOneAndWhatCannotBeWrittenIsTold) {
  moving({{kNow_ns, 1, {0.5, 0, 2}}});
  model_.images.push_back({.camera = 0, .frame = FrameId(9), .t_ns = 9'000'000'000, .name = "a/9.png"});
  mask();
  EXPECT_TRUE(std::filesystem::exists(out_ / "a/9.png.png"));
  temp_.write("file", "");
  EXPECT_NE(test::error_of<UserError>([&] { write_masks(result_, model_, temp_ / "file"); }), "");
}

}  // namespace
}  // namespace coslam::exporting::masks_test
