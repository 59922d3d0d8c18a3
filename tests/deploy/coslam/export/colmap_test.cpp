// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/dataset/calibration.h"
#include "common/dataset/trajectory.h"
#include "deploy/coslam/export/export.h"
#include "tests/support/temp_folder.h"

namespace coslam::exporting::colmap_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<double> numbers_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<double> out;
  for (double number = 0; stream >> number;) out.push_back(number);
  return out;
}

// A camera that goes half a metre to the right; its frames 0 and 10 saw sixteen points.
class ColmapFiles : public ::testing::Test {
 protected:
  void write_result(const CameraModel& lens, int points = 16) {
    save_calibration(temp_ / "calib.yaml", lens);
    const CameraModel camera = load_calibration(temp_ / "calib.yaml");
    sequence_.rate_hz = 20;
    sequence_.agents = {{.name = "a", .source = (temp_ / "shot").string(), .calibration = temp_ / "calib.yaml"}};
    Trajectory path;
    fs::create_directories(temp_ / "shot");
    for (int i = 0; i <= 10; ++i) {
      path.push_back({i * 50'000'000LL, {Eigen::Quaterniond::Identity(), {-0.05 * i, 0, 0}}});
      cv::imwrite((temp_ / ("shot/" + std::to_string(100 + i) + ".png")).string(),
                  cv::Mat(camera.height_px, camera.width_px, CV_8UC1, cv::Scalar(90)));
    }
    save_tum(result_.trajectory("a"), path);
    PointWriter written(result_.points());
    TrackWriter tracks(result_.tracks("a"));
    for (int i = 0; i < points; ++i) {
      ResultPoint point;
      point.id = PointId(static_cast<std::uint32_t>(i + 1));
      point.position = {0.4 * (i % 4) - 0.5, 0.3 * (i / 4) - 0.4, 3 + 0.1 * ((i * 7) % 5)};
      written.write(point);
      for (const std::uint32_t frame : {0U, 10U}) {
        const Eigen::Vector2d px = camera.project(path[frame].cam_from_world * point.position);
        tracks.write({FrameId(frame), frame * 50'000'000LL, TrackId(point.id.value), camera.raw_from_undistorted(px),
                      point.id, PointState::kStatic});
      }
    }
    written.close();
    tracks.close();
  }
  ResultMap map() const { return contents_of(result_).maps.front(); }

  const LogPause quiet_;
  test::TempFolder temp_;
  ResultFolder result_{temp_ / "result"};
  fs::path out_ = temp_ / "out";
  Sequence sequence_;
};

constexpr int kWidth_px = 320, kHeight_px = 240;

TEST_F(ColmapFiles, LensesAreThoseThatColmapHasNamesFor) {
  const std::pair<CameraModel, std::string> lenses[] = {
      {{kWidth_px, kHeight_px, 200, 201, 160, 120, DistortionModel::kNone, {}},
       "1 PINHOLE 320 240 200 201 160.5 120.5"},
      {{kWidth_px, kHeight_px, 200, 201, 160, 120, DistortionModel::kEquidistant, {0.01, 0.02, 0, 0.001}},
       "1 OPENCV_FISHEYE 320 240 200 201 160.5 120.5 0.01 0.02 0 0.001"},
      {{kWidth_px, kHeight_px, 200, 201, 160, 120, DistortionModel::kRadTan, {-0.1, 0.02, 0, 0, 0.001}},
       "1 FULL_OPENCV 320 240 200 201 160.5 120.5 -0.1 0.02 0 0 0.001 0 0 0"}};
  for (const auto& [lens, line] : lenses) {
    write_result(lens);
    const Files files = export_colmap(map(), sequence_, out_, {});
    EXPECT_EQ(lines_of(files.at(0)).back(), line);
    EXPECT_EQ(load_calibration(files.at(0)).fy, 201) << "it reads back";
    EXPECT_THAT(lines_of(files.at(2)).at(1), HasSubstr("# Number of points: 16, mean reprojection error: 0.0"));
  }
}

TEST_F(ColmapFiles, ASphereIsRefusedWithWhatHelps) {
  const CameraModel sphere{kWidth_px, kHeight_px, 150, 150, 160, 120, DistortionModel::kDoubleSphere, {-0.2, 0.59}};
  write_result(sphere);
  EXPECT_THAT(test::error_of<UserError>([&] { export_colmap(map(), sequence_, out_, {}); }),
              HasSubstr("(double_sphere): add --undistort"));
  const Files files = export_colmap_undistorted(map(), sequence_, out_, {});
  EXPECT_THAT(lines_of(files.at(0)).back(), HasSubstr("1 PINHOLE "));
}

TEST_F(ColmapFiles, AnImageHasItsObservationsInPairsOfNumberAndPoint) {
  write_result({kWidth_px, kHeight_px, 200, 201, 160, 120, DistortionModel::kNone, {}});
  const Files files = export_colmap(map(), sequence_, out_, {});
  const auto images = lines_of(files.at(1)), points = lines_of(files.at(2));
  ASSERT_EQ(images.size(), 2U + 4U);
  ASSERT_EQ(points.size(), 2U + 16U);
  const std::vector<double> observations = numbers_of(images[3]), pose = numbers_of(images[4]);
  ASSERT_EQ(observations.size(), 3U * 16U);
  EXPECT_EQ(pose.at(0), 2);
  EXPECT_NEAR(pose.at(5), -0.5, 0.01);
  for (std::size_t p = 2; p < points.size(); ++p) {
    const std::vector<double> point = numbers_of(points[p]);
    ASSERT_EQ(point.size(), 8U + 4U);
    // Its first observation is of it, and where the pinhole sees it: the first image is at the origin.
    const auto of_first = static_cast<std::size_t>(point[9]);
    EXPECT_EQ(point[8], 1);
    EXPECT_EQ(observations[3 * of_first + 2], point[0]);
    EXPECT_NEAR(observations[3 * of_first], 200 * point[1] / point[3] + 160.5, 0.2);
  }
}

TEST_F(ColmapFiles, WhatDenseStereoNeedsLiesBesideTheModel) {
  write_result({kWidth_px, kHeight_px, 200, 201, 160, 120, DistortionModel::kRadTan, {-0.1, 0.02, 0, 0}});
  const Files files = export_colmap_undistorted(map(), sequence_, out_, {});
  EXPECT_THAT(files, ElementsAre(out_ / "sparse/cameras.txt", out_ / "sparse/images.txt", out_ / "sparse/points3D.txt",
                                 out_ / "images", out_ / "stereo"))
      << "without masks, for nothing moves";
  EXPECT_THAT(lines_of(out_ / "stereo/patch-match.cfg"),
              ElementsAre("a/100.png", "__auto__, 20", "a/110.png", "__auto__, 20"));
  EXPECT_THAT(lines_of(out_ / "stereo/fusion.cfg"), ElementsAre("a/100.png", "a/110.png"));
  for (const char* maps : {"depth_maps", "normal_maps", "consistency_graphs"}) {
    EXPECT_TRUE(fs::is_directory(out_ / "stereo" / maps / "a")) << maps;
  }
  EXPECT_EQ(lines_of(out_ / "sparse/0/images.txt"), lines_of(out_ / "sparse/images.txt"));
  EXPECT_TRUE(fs::exists(out_ / "images/a/110.png"));
  EXPECT_NO_THROW(export_colmap_undistorted(map(), sequence_, out_, {})) << "once more over the same";
}

TEST_F(ColmapFiles, WhereNothingCanBeWrittenThatIsSaid) {
  write_result({kWidth_px, kHeight_px, 200, 201, 160, 120, DistortionModel::kNone, {}});
  temp_.write("file", "");
  EXPECT_THAT(test::error_of<UserError>([&] { export_colmap(map(), sequence_, temp_ / "file", {}); }),
              HasSubstr("file"));
  temp_.write("out/stereo/depth_maps", "");
  EXPECT_THAT(test::error_of<UserError>([&] { export_colmap_undistorted(map(), sequence_, out_, {}); }),
              HasSubstr("depth_maps: cannot be made"));
}

TEST_F(ColmapFiles, TooFewPointsMakeNoModel) {
  write_result({kWidth_px, kHeight_px, 200, 201, 160, 120, DistortionModel::kNone, {}}, 7);
  EXPECT_THAT(test::error_of<UserError>([&] { export_colmap(map(), sequence_, out_, {}); }),
              HasSubstr("no image of the sequence has a pose and enough points"));
}

}  // namespace
}  // namespace coslam::exporting::colmap_test
