// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/colmap_model.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/dataset/calibration.h"
#include "common/dataset/trajectory.h"
#include "tests/deploy/coslam/export/simulated_model.h"
#include "tests/support/temp_folder.h"

namespace coslam::exporting::colmap_model_test {
namespace {

using coslam::test::error_of;
using coslam::test::TempFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> names_of(const ColmapModel& model) {
  std::vector<std::string> out;
  for (const auto& image : model.images) out.push_back(image.name);
  return out;
}

// Images without observations, the frames 0, 1, ... of each camera.
ColmapModel images_of(const std::vector<std::vector<PlayedImage>>& cameras, std::uint32_t frames) {
  ColmapModel model;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    model.cameras.push_back({{.name = std::string(1, static_cast<char>('a' + c))}, kPinhole, cameras[c]});
    for (std::uint32_t f = 0; f < frames; ++f) model.images.push_back({.camera = c, .frame = FrameId(f)});
  }
  return model;
}

std::vector<PlayedImage> played(const std::vector<std::string>& files) {
  std::vector<PlayedImage> out;
  for (const std::string& file : files) out.push_back({FrameId(static_cast<std::uint32_t>(out.size())), 0, file});
  return out;
}

TEST(LinkPoints, EveryTrackNamesTheObservationsOfItsPoint) {
  const ColmapModel model = simulated_model(6, 40, 0);
  ASSERT_EQ(model.images.size(), 6U);
  EXPECT_GT(model.points.size(), 30U);
  std::size_t observed = 0, tracked = 0;
  for (const auto& image : model.images) {
    observed += static_cast<std::size_t>(
        std::ranges::count_if(image.observations, [](const auto& o) { return o.point != PointId(); }));
  }
  for (const auto& [id, point] : model.points) {
    EXPECT_GE(point.track.size(), 2U);
    for (const auto& e : point.track) EXPECT_EQ(model.images[e.image].observations[e.observation].point, id);
    tracked += point.track.size();
  }
  EXPECT_EQ(observed, tracked);
}

TEST(LinkPoints, APointThatOneImageSeesGoesAndTheObservationStays) {
  ColmapModel model = simulated_model(4, 40, 0);
  model.points[PointId(900)].position = {0, 0, 5};
  model.images[1].observations.push_back({{5, 6}, PointId(900)});
  link_points(&model);
  EXPECT_FALSE(model.points.contains(PointId(900)));
  EXPECT_EQ(model.images[1].observations.back().point, PointId());
  EXPECT_EQ(model.images[1].observations.back().px, Eigen::Vector2d(5, 6));
}

TEST(LinkPoints, OfTwoTracksOnOnePointAnImageKeepsOne) {
  ColmapModel model = simulated_model(4, 40, 0);
  const PointId twice = model.images[2].observations.front().point;
  const std::size_t length = model.points.at(twice).track.size();
  model.images[2].observations.push_back({{7, 8}, twice});
  link_points(&model);
  EXPECT_EQ(model.points.at(twice).track.size(), length);
  EXPECT_EQ(model.images[2].observations.back().point, PointId());
}

TEST(LinkPoints, AnImageThatShowsTooLittleGoesWithWhatItAloneHeld) {
  ColmapModel model = simulated_model(4, 40, 0);
  model.points[PointId(900)].position = {0, 0, 5};
  ColmapModel::Image poor = model.images[0];
  poor.observations.resize(6);
  poor.observations.push_back({{1, 2}, PointId(900)});
  model.images.insert(model.images.begin(), poor);
  model.images[2].observations.push_back({{5, 6}, PointId(900)});
  link_points(&model);
  EXPECT_EQ(model.images.size(), 4U);
  EXPECT_FALSE(model.points.contains(PointId(900))) << "one view of it is left";
  for (const auto& [id, point] : model.points) {
    for (const auto& e : point.track) EXPECT_EQ(model.images[e.image].observations[e.observation].point, id);
  }
}

TEST(LinkPoints, WhereNothingHoldsTogetherNothingIsLeft) {
  ColmapModel model = simulated_model(4, 5, 0);
  EXPECT_TRUE(model.images.empty());
  EXPECT_TRUE(model.points.empty());
}

TEST(ErrorOfPoint, IsADistanceInTheImageAsItWasTaken) {
  ColmapModel model = simulated_model(4, 40, 0);
  const auto& [id, point] = *model.points.begin();
  ASSERT_GE(point.track.size(), 2U);
  EXPECT_LT(mean_error_px(model, point), 1e-9);
  const auto first = point.track.front();
  model.images[first.image].observations[first.observation].px += Eigen::Vector2d(3, -4);
  EXPECT_NEAR(error_px(model, point, first), 5, 1e-9);
  EXPECT_NEAR(mean_error_px(model, point), 5.0 / static_cast<double>(point.track.size()), 1e-9);
  EXPECT_NEAR(mean_error_px(model), mean_error_px(model, point) / static_cast<double>(model.points.size()), 1e-9);
  model.images[first.image].cam_from_world = Rigid3(so3_exp({0, M_PI, 0}), {0, 0, 0});
  EXPECT_EQ(error_px(model, point, first), std::numeric_limits<double>::infinity()) << "it is behind the camera";
}

TEST(NamesOfImages, AreThoseOfFilesFromTheFolderThatHasThemAll) {
  ColmapModel model = images_of({played({"/data/run/left/1.png", "/data/run/left/2.png"}),
                                 played({"/data/run/x/../right/1.png", "/data/run/right/2.png"})},
                                2);
  EXPECT_EQ(name_as_files(&model), "/data/run");
  EXPECT_THAT(names_of(model), ElementsAre("left/1.png", "left/2.png", "right/1.png", "right/2.png"));
  name_as_pngs(&model);
  EXPECT_THAT(names_of(model), ElementsAre("a/1.png", "a/2.png", "b/1.png", "b/2.png"));
}

TEST(NamesOfImages, OfOneFolderAreTheNamesAlone) {
  ColmapModel model = images_of({played({"/data/1.jpg", "/data/2.jpg"})}, 2);
  EXPECT_EQ(name_as_files(&model), "/data");
  EXPECT_THAT(names_of(model), ElementsAre("1.jpg", "2.jpg"));
}

TEST(NamesOfImages, WithoutFilesAreNumbers) {
  ColmapModel model = images_of({{}, played({"", ""})}, 2);
  EXPECT_EQ(name_as_files(&model), "");
  EXPECT_THAT(names_of(model), ElementsAre("a/000000.png", "a/000001.png", "b/000000.png", "b/000001.png"));
  name_as_pngs(&model);
  EXPECT_EQ(names_of(model)[3], "b/000001.png");
}

TEST(NamesOfImages, ThoseOfACameraWithOneFileTwiceAreNumbers) {
  ColmapModel model =
      images_of({played({"/d/1.png", "/d/2.png", "/d/1.png"}), played({"/d/7.png", "/d/8.png", "/d/9.png"})}, 3);
  EXPECT_EQ(name_as_files(&model), "/d");
  EXPECT_THAT(names_of(model), ElementsAre("a/000000.png", "a/000001.png", "a/000002.png", "7.png", "8.png", "9.png"));
  ColmapModel shared = images_of({played({"/d/1.png"}), played({"/d/1.png"})}, 1);
  name_as_files(&shared);
  EXPECT_THAT(names_of(shared), ElementsAre("1.png", "b/000000.png"));
}

// A result of one camera that goes to the right; it saw eleven points in frames 0, 10 and 20.
class ReadColmapModel : public ::testing::Test {
 protected:
  ReadColmapModel() {
    save_calibration(temp_ / "calib.yaml", kPinhole);
    sequence_.rate_hz = 20;
    sequence_.agents.push_back({.name = "a", .calibration = temp_ / "calib.yaml"});
    sequence_.agents.push_back({.name = "absent", .calibration = temp_ / "none.yaml"});
    Trajectory path;
    for (int i = 0; i <= 20; ++i) path.push_back({i * 50'000'000LL, pose_of(i)});
    save_tum(result_.trajectory("a"), path);
    PointWriter points(result_.points());
    for (std::uint32_t id = 1; id <= 11; ++id) {
      ResultPoint point;
      point.id = PointId(id);
      point.position = place_of(id);
      points.write(point);
    }
    ResultPoint moving;
    moving.id = PointId(50);
    moving.state = PointState::kDynamic;
    points.write(moving);
    points.close();
  }

  static Rigid3 pose_of(int frame) { return {Eigen::Quaterniond::Identity(), {-0.02 * frame, 0, 0}}; }
  static Eigen::Vector3d place_of(std::uint32_t id) { return {0.2 * id - 1, 0.1 * (id % 5), 3 + 0.1 * (id % 3)}; }
  static Eigen::Vector2d px_of(int frame, std::uint32_t id) { return kPinhole.project(pose_of(frame) * place_of(id)); }
  static void write_frame(TrackWriter* tracks, int frame, std::optional<PointState> state = PointState::kStatic) {
    for (std::uint32_t id = 1; id <= 11; ++id) {
      tracks->write({FrameId(static_cast<std::uint32_t>(frame)), frame * 50'000'000LL, TrackId(id), px_of(frame, id),
                     state ? PointId(id) : PointId(), state});
    }
  }
  ColmapModel read(int every = kTracksOfEvery) const {
    return read_colmap_model(contents_of(result_).maps.front(), sequence_, every);
  }

  const LogPause quiet_;
  TempFolder temp_;
  ResultFolder result_{temp_ / "result"};
  Sequence sequence_;
};

TEST_F(ReadColmapModel, ATrackShowsItsPointBeforeThatWasMade) {
  TrackWriter tracks(result_.tracks("a"));
  write_frame(&tracks, 0, std::nullopt);
  write_frame(&tracks, 10);
  tracks.close();
  const ColmapModel model = read();
  ASSERT_EQ(model.images.size(), 2U);
  EXPECT_EQ(model.points.size(), 11U);
  EXPECT_EQ(model.images[0].observations[4].point, PointId(5));
  EXPECT_LT(mean_error_px(model), 0.01);
  EXPECT_EQ(model.cameras.size(), 1U) << "the other agent is not in this map";
}

TEST_F(ReadColmapModel, WhatWasSeenToMoveShowsNoPoint) {
  TrackWriter tracks(result_.tracks("a"));
  write_frame(&tracks, 0);
  write_frame(&tracks, 10);
  const PointId moving(50);
  tracks.write({FrameId(20), 1'000'000'000, TrackId(3), {1, 2}, PointId(3), PointState::kDynamic});
  tracks.write({FrameId(20), 1'000'000'000, TrackId(70), {1, 2}, moving, PointState::kDynamic});
  for (std::uint32_t id = 4; id <= 11; ++id)
    tracks.write({FrameId(20), 1'000'000'000, TrackId(id), px_of(20, id), PointId(id), PointState::kStatic});
  tracks.close();
  const ColmapModel model = read();
  ASSERT_EQ(model.images.size(), 3U);
  EXPECT_EQ(model.images[2].observations[0].point, PointId());
  EXPECT_EQ(model.images[2].observations[1].point, PointId());
  EXPECT_EQ(model.points.at(PointId(3)).track.size(), 2U);
  EXPECT_FALSE(model.points.contains(moving));
}

TEST_F(ReadColmapModel, FewerImagesAreThoseOfWholeMultiples) {
  TrackWriter tracks(result_.tracks("a"));
  for (const int frame : {0, 10, 20}) write_frame(&tracks, frame);
  tracks.close();
  EXPECT_EQ(read().images.size(), 3U);
  const ColmapModel model = read(20);
  ASSERT_EQ(model.images.size(), 2U);
  EXPECT_EQ(model.images[1].frame, FrameId(20));
}

TEST_F(ReadColmapModel, ARestartedAgentCountsAnewAndItsTracksAreOthers) {
  TrackWriter tracks(result_.tracks("a"));
  write_frame(&tracks, 0);
  write_frame(&tracks, 10);
  for (std::uint32_t id = 1; id <= 10; ++id)
    tracks.write({FrameId(20), 1'000'000'000, TrackId(id), px_of(20, id), PointId(id), PointState::kStatic});
  tracks.write({FrameId(20), 1'000'000'000, TrackId(12), {321, 123}, PointId(), std::nullopt});
  tracks.write({FrameId(0), 1'200'000'000, TrackId(12), {300, 200}, PointId(11), PointState::kStatic});
  tracks.close();
  const ColmapModel model = read();
  ASSERT_EQ(model.images.size(), 3U) << "its frame 0 is there already";
  EXPECT_EQ(model.images[0].observations.size(), 11U);
  EXPECT_EQ(model.images[2].observations.back().px, Eigen::Vector2d(321, 123));
  EXPECT_EQ(model.images[2].observations.back().point, PointId()) << "a track of another run showed that point";
}

TEST_F(ReadColmapModel, TheLensIsTheOneThatWasFound) {
  TrackWriter tracks(result_.tracks("a"));
  write_frame(&tracks, 0);
  write_frame(&tracks, 10);
  tracks.close();
  EXPECT_EQ(read().cameras[0].model.fx, kPinhole.fx);
  CameraModel found = kPinhole;
  found.fx = 505;
  save_calibration(result_.calibration("a"), found);
  EXPECT_EQ(read().cameras[0].model.fx, 505);
}

TEST_F(ReadColmapModel, ImagesBetweenMoveAsTheirNeighboursDid) {
  TrackWriter tracks(result_.tracks("a"));
  write_frame(&tracks, 0);
  write_frame(&tracks, 10);
  tracks.close();
  ColmapModel model = read();
  const ResultMap map = contents_of(result_).maps.front();
  EXPECT_THAT(error_of<UserError>([&] { add_images_between(map, 5, &model); }), HasSubstr("agent a: images between"));
  for (std::uint32_t f = 0; f <= 20; ++f) model.cameras[0].played.push_back({FrameId(f), f * 50'000'000LL, {}});
  add_images_between(map, kTracksOfEvery, &model);
  EXPECT_EQ(model.images.size(), 2U) << "there are no others";

  const Rigid3 change(so3_exp({0, 0.1, 0}), {0, 0.2, 0});  // of the second image alone
  model.images[1].cam_from_world = model.images[1].cam_from_world * change;
  add_images_between(map, 5, &model);
  ASSERT_EQ(model.images.size(), 4U);
  EXPECT_EQ(model.images[2].frame, FrameId(5));
  const Rigid3 half = pose_of(5).inverse() * model.images[2].cam_from_world;
  EXPECT_NEAR(so3_log(half.rotation).y(), 0.05, 1e-3);
  EXPECT_NEAR(half.translation.y(), 0.1, 1e-3);
  EXPECT_EQ(model.images[3].frame, FrameId(15));
  const Rigid3 after = pose_of(15).inverse() * model.images[3].cam_from_world;
  EXPECT_NEAR(so3_log(after.rotation).y(), 0.1, 1e-6) << "behind the last one as that";
  EXPECT_TRUE(model.images[3].observations.empty());
}

}  // namespace
}  // namespace coslam::exporting::colmap_model_test
