// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/export.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "common/base/error.h"
#include "common/dataset/calibration.h"
#include "common/dataset/trajectory.h"
#include "tests/support/temp_folder.h"

namespace coslam::exporting::export_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

class Export : public ::testing::Test {
 protected:
  Export() {
    // Camera a at (1, 2, 3), turned by 180 degrees about z; half a second later it is at (4, 5, 6).
    save_tum(result_.trajectory("a"), {{0, Rigid3({0, 0, 0, 1}, {1, 2, 3}).inverse()},
                                       {500'000'000, Rigid3(Eigen::Quaterniond::Identity(), {-4, -5, -6})}});
  }
  ResultMap common() const { return contents_of(result_).maps.front(); }

  test::TempFolder temp_;
  ResultFolder result_{temp_ / "result"};
  std::filesystem::path out_ = temp_ / "out";
};

TEST_F(Export, Trajectories) {
  EXPECT_THAT(export_tum(common(), out_), ElementsAre(out_ / "a.tum"));
  EXPECT_EQ(load_tum(out_ / "a.tum").size(), 2u);
  export_euroc(common(), out_);
  const auto euroc = lines_of(out_ / "a.csv");
  ASSERT_EQ(euroc.size(), 3u);
  EXPECT_THAT(euroc[1], HasSubstr("0,1.000000000,2.000000000,3.000000000,0.0000"));
  EXPECT_THAT(euroc[2], HasSubstr("500000000,"));
  export_kitti(common(), out_);
  std::istringstream kitti(lines_of(out_ / "a.txt").at(0));
  std::vector<double> m(12);
  for (double& v : m) kitti >> v;
  EXPECT_THAT(m, ::testing::Pointwise(::testing::DoubleNear(1e-9), {-1., 0., 0., 1., 0., -1., 0., 2., 0., 0., 1., 3.}));
  EXPECT_THAT(lines_of(out_ / "a.times.txt"), ElementsAre("0.000000000", "0.500000000"));
}

TEST_F(Export, SaysWherePosesAreMissing) {
  EXPECT_EQ(gaps_of(common()), "");
  Trajectory path;
  for (const int i : {0, 1, 2, 3, 9, 10, 11, 14, 15}) path.push_back({i * 100'000'000LL, Rigid3()});
  save_tum(result_.trajectory("a"), path);
  EXPECT_EQ(gaps_of(common()), "a has no pose at 2 places, the longest of 0.60 s after 0.30 s");
}

TEST_F(Export, Ply) {
  EXPECT_THAT(test::error_of<UserError>([&] { export_ply(common(), out_); }),
              HasSubstr("map.ply: there is no such map"));
  write_ply(result_.map(), {ResultPoint()}, LengthUnit::kMetres);
  EXPECT_THAT(export_ply(common(), out_), ElementsAre(out_ / "map.ply"));
  EXPECT_EQ(lines_of(out_ / "map.ply").at(0), "ply");
}

// Sixteen points that both images see; points 1 to 16.
Eigen::Vector3d seen_point(int i) { return {2.0 + i % 4, 3.0 + i / 4, 14.0 + (i * 7) % 5}; }

// Camera a with two images that have tracks, frames 0 and 10.
class ColmapExport : public Export {
 protected:
  ColmapExport() {
    save_calibration(temp_ / "calib.yaml", camera_);
    sequence_.rate_hz = 20;
    sequence_.agents.push_back({"a", "", temp_ / "calib.yaml", 0, {}, {}});
    const Trajectory path = load_tum(result_.trajectory("a"));
    const auto raw_px = [&](std::size_t image, int i) {
      return camera_.raw_from_undistorted(camera_.project(path[image].cam_from_world * seen_point(i)));
    };
    PointWriter points(result_.points());
    TrackWriter tracks(result_.tracks("a"));
    for (int i = 0; i < 17; ++i) {
      ResultPoint point;
      point.id = PointId(static_cast<std::uint32_t>(i + 1));
      point.position = seen_point(i);
      points.write(point);
      const TrackId track(static_cast<std::uint32_t>(i + 1));
      const PointId then = i == 3 ? PointId() : point.id;  // it had no point yet
      tracks.write({FrameId(0), 0, track, raw_px(0, i), then, PointState::kStatic});
    }
    tracks.write({FrameId(0), 0, TrackId(18), {3, 4}, PointId(99), PointState::kDynamic});
    for (int i = 0; i < 16; ++i) {  // point 17 is seen once
      const Eigen::Vector2d off(0, i == 5 ? 40 : 0);
      const TrackId track(static_cast<std::uint32_t>(i + 1));
      tracks.write({FrameId(10), 500'000'000, track, raw_px(1, i) + off, PointId(track.value), PointState::kStatic});
    }
    tracks.write({FrameId(20), 900'000'000, TrackId(1), {9, 9}, PointId(1), PointState::kStatic});  // has no pose
    points.close();
    tracks.close();
  }
  // Images of one colour, as the source of camera a; with a pose for each.
  void write_images(const cv::Scalar& bgr) {
    std::filesystem::create_directories(temp_ / "shot");
    std::ofstream times(temp_ / "shot/times.txt");
    Trajectory path = load_tum(result_.trajectory("a"));
    for (int i = 0; i <= 10; ++i) {
      times << 0.05 * i << "\n";
      cv::imwrite((temp_ / ("shot/" + std::to_string(100000 + i) + ".png")).string(),
                  cv::Mat(camera_.height_px, camera_.width_px, CV_8UC3, bgr));
      if (i % 10 != 0)
        path.insert(path.end() - 1,
                    {i * 50'000'000LL, interpolate(path.front().cam_from_world, path.back().cam_from_world, 0.1 * i)});
    }
    save_tum(result_.trajectory("a"), path);
    sequence_.agents[0].source = (temp_ / "shot").string();
  }

  const CameraModel camera_{640, 480, 400, 410, 320, 240, DistortionModel::kRadTan, {0.1, 0, 0, 0}};
  Sequence sequence_;
};

TEST_F(ColmapExport, HasImagesPointsAndTracks) {
  const auto files = export_colmap(common(), sequence_, out_, {});
  EXPECT_EQ(lines_of(files[0]).back(), "1 OPENCV 640 480 400 410 320.5 240.5 0.1 0 0 0");
  const auto images = lines_of(files[1]);
  ASSERT_EQ(images.size(), 6u);
  EXPECT_THAT(images[2], HasSubstr(" 1 a/000000.png"));
  EXPECT_THAT(images[3], HasSubstr(" 3.500 4.500 -1"));
  std::istringstream pose(images[4]);
  std::vector<double> numbers(9);
  for (double& n : numbers) pose >> n;
  EXPECT_THAT(numbers, ::testing::Pointwise(::testing::DoubleNear(0.01), {2., 1., 0., 0., 0., -4., -5., -6., 1.}));
  EXPECT_THAT(images[4], HasSubstr(" 1 a/000010.png"));
  const auto model_points = lines_of(files[2]);
  ASSERT_EQ(model_points.size(), 2u + 15u);  // without 6, of which one observation is wrong, and 17
  EXPECT_THAT(model_points[1], HasSubstr("# Number of points: 15, mean reprojection error: 0.0"));
  EXPECT_EQ(model_points[2].substr(0, 2), "1 ");
  EXPECT_THAT(model_points[5], HasSubstr(" 1 3 2 3"));
}

TEST_F(ColmapExport, NamesImagesAsTheirFilesAndTakesThoseBetween) {
  write_images({30, 60, 90});
  const auto all = lines_of(export_colmap(common(), sequence_, out_, {.every = 5})[1]);
  ASSERT_EQ(all.size(), 2u + 2u * 3u);
  EXPECT_THAT(all[2], HasSubstr(" 1 100000.png"));
  EXPECT_THAT(all[6], HasSubstr(" 1 100005.png"));
  EXPECT_EQ(all[7], "") << "no tracks are known of it";
  std::istringstream pose(all[6]);
  std::vector<double> numbers(8);
  for (double& n : numbers) pose >> n;
  const Rigid3 between = interpolate(load_tum(result_.trajectory("a")).front().cam_from_world,
                                     load_tum(result_.trajectory("a")).back().cam_from_world, 0.5);
  EXPECT_NEAR(numbers[5], between.translation.x(), 0.05);
  EXPECT_NEAR(numbers[7], between.translation.z(), 0.05);
}

TEST_F(ColmapExport, NoTwoImagesHaveOneName) {
  write_images({30, 60, 90});
  std::ofstream list(temp_ / "list.csv");
  for (int i = 0; i <= 10; ++i) list << 0.05 * i << ",shot/" << 100000 + i % 2 << ".png\n";
  list.close();
  sequence_.agents[0].source = (temp_ / "list.csv").string();
  const auto images = lines_of(export_colmap(common(), sequence_, out_, {.every = 5})[1]);
  EXPECT_THAT(images[2], HasSubstr(" 1 a/000000.png"));
  EXPECT_THAT(images[4], HasSubstr(" 1 a/000010.png"));
}

TEST_F(ColmapExport, UndistortedHasImagesAndMasksOfWhatMoves) {
  write_images({30, 60, 90});
  DynamicWriter moving(result_.dynamic());
  moving.write({.t_ns = 0, .id = PointId(70), .position = seen_point(5)});
  moving.close();
  export_colmap_undistorted(common(), sequence_, out_, {});
  EXPECT_THAT(lines_of(out_ / "sparse/images.txt")[2], HasSubstr(" 1 a/100000.png"));
  const cv::Mat image = cv::imread((out_ / "images/a/100000.png").string());
  ASSERT_FALSE(image.empty());
  EXPECT_EQ(image.at<cv::Vec3b>(100, 100), cv::Vec3b(30, 60, 90));
  const cv::Mat mask = cv::imread((out_ / "masks/a/100000.png.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(mask.size(), image.size());
  const double black = mask.total() - static_cast<double>(cv::countNonZero(mask));
  EXPECT_GT(black, 500);
  EXPECT_LT(black, 4000);
  const cv::Mat later = cv::imread((out_ / "masks/a/100010.png.png").string(), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(cv::countNonZero(later), static_cast<int>(later.total()));
}

TEST_F(ColmapExport, PlyGetsTheColoursOfTheImages) {
  write_images({30, 60, 90});
  const auto file = export_ply_in_colour(common(), sequence_, out_).front();
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::string end = "end_header\n";
  const auto colour = text.substr(text.find(end) + end.size() + 12, 3);
  EXPECT_EQ(colour, (std::string{90, 60, 30}));
}

TEST_F(Export, EachMapByItself) {
  const ResultFolder apart = result_.of_map(MapId(4));
  save_tum(apart.trajectory("b"), load_tum(result_.trajectory("a")));
  for (const ResultFolder& folder : {result_, apart}) write_ply(folder.map(), {ResultPoint()}, LengthUnit::kMetres);
  save_tum(result_.trajectory("b"), {});
  save_tum(result_.trajectory("of_another_run"), {});
  write_json(result_.report(), {{"agents", {{"a", {}}, {"b", {}}}},
                                {"maps",
                                 {{{"map", 1}, {"agents", {{"a", 2}}}, {"scale_known", true}},
                                  {{"map", 4}, {"agents", {{"b", 2}}}, {"scale_known", false}}}}});
  const ResultContents contents = contents_of(result_);
  EXPECT_THAT(export_maps(contents, out_, export_tum), ElementsAre(out_ / "a.tum", out_ / "maps/4/b.tum"));
  EXPECT_EQ(load_tum(out_ / "maps/4/b.tum").size(), 2u);
  EXPECT_THAT(lines_of(out_ / "a.tum")[0], HasSubstr("lengths are metres"));
  EXPECT_THAT(lines_of(out_ / "maps/4/b.tum")[0], HasSubstr("scale unknown"));
  export_maps(contents, out_, export_euroc);
  EXPECT_THAT(lines_of(out_ / "a.csv")[0], HasSubstr("p_x [m],"));
  EXPECT_THAT(lines_of(out_ / "maps/4/b.csv")[0], HasSubstr("p_x [map units, scale unknown],"));
  EXPECT_THAT(export_maps(contents, out_, export_ply), ElementsAre(out_ / "map.ply", out_ / "maps/4/map.ply"));
}

TEST_F(Export, SaysWhatIsMissing) {
  const ResultFolder empty(temp_ / "empty");
  const ResultMap nothing = contents_of(empty).maps.front();
  EXPECT_THAT(test::error_of<UserError>([&] { export_tum(nothing, out_); }), HasSubstr("no trajectory/<agent>.tum"));
}

}  // namespace
}  // namespace coslam::exporting::export_test
