// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <thread>

#include "common/base/error.h"
#include "deploy/simulation/scene.h"

namespace coslam::sim::writer_test {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

int lines_of(const fs::path& file) {
  const std::string text = text_of(file);
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

class WriterTest : public testing::Test {
 protected:
  static constexpr int kFrames = 11, kCameras = 2;

  void SetUp() override {
    root_ = fs::temp_directory_path() / ("coslam-writer-test-" + std::to_string(getpid()));
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  fs::path write(const std::string& folder, std::uint64_t seed,
                 const std::function<void(int, int)>& progress = {}) const {
    const auto scene = make_simulated_scene("room", seed, {kCameras, kFrames, 0.25});
    write_sequence(*scene, {"room", seed, 2, 12.0}, root_ / folder, progress);
    return root_ / folder;
  }

  fs::path root_;
};

TEST_F(WriterTest, WritesEverythingOfTheContract) {
  std::vector<int> reports;
  const auto caller = std::this_thread::get_id();
  const fs::path out = write("out", 3, [&](int done, int total) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    EXPECT_EQ(total, kFrames * kCameras);
    reports.push_back(done);
  });
  EXPECT_TRUE(std::is_sorted(reports.begin(), reports.end()));
  EXPECT_EQ(reports.back(), kFrames * kCameras);
  for (const std::string name : {"cam0", "cam1"}) {
    for (int frame = 0; frame < kFrames; ++frame) {
      const std::string image = (frame < 10 ? "00000" : "0000") + std::to_string(frame) + ".png";
      const cv::Mat read = cv::imread((out / name / image).string(), cv::IMREAD_UNCHANGED);
      EXPECT_EQ(read.size(), cv::Size(160, 120));
      EXPECT_EQ(read.type(), CV_8UC1);
      EXPECT_EQ(fs::exists(out / "depth" / name / image), frame % 10 == 0);
    }
    EXPECT_EQ(cv::imread((out / "depth" / name / "000010.png").string(), cv::IMREAD_UNCHANGED).type(), CV_16UC1);
    EXPECT_EQ(lines_of(out / name / "times.txt"), kFrames);
    EXPECT_EQ(lines_of(out / (name + ".tum")), kFrames + 1);  // and a heading
    EXPECT_NE(text_of(out / (name + ".yaml")).find("distortion_model: radtan"), std::string::npos);
  }
  const std::string sequence = text_of(out / "sequence.yaml");
  for (const char* part :
       {"rate_hz: 30", "scene: room", "scene_seed: 3", "scale: {baseline_m: 0.", "truth: cam1.tum"}) {
    EXPECT_NE(sequence.find(part), std::string::npos) << part;
  }
  EXPECT_NE(sequence.find("overlap: overlap.csv"), std::string::npos);
  EXPECT_EQ(lines_of(out / "overlap.csv"), 1 + 2 * 4);  // both ways at frames 0, 3, 6 and 9
  EXPECT_EQ(text_of(out / "overlap.csv").rfind("t_s,agent_a,agent_b,share\n0.000000000,cam0,cam1,0.", 0), 0U);
  EXPECT_EQ(std::distance(fs::directory_iterator(root_), {}), 1);  // nothing left beside it
}

TEST_F(WriterTest, NoScaleForCamerasThatStartApart) {
  const auto scene = make_simulated_scene("twins", 3, {kCameras, 1, 0.25});
  write_sequence(*scene, {"twins", 3, 2, 12.0}, root_ / "out", {});
  EXPECT_EQ(text_of(root_ / "out/sequence.yaml").find("scale"), std::string::npos);
}

TEST_F(WriterTest, WhatMovesHasMasksAndMarkedPoints) {
  const auto scene = make_simulated_scene("walking-man", 3, {kCameras, 2, 0.25});
  write_sequence(*scene, {"walking-man", 3, 2, 12.0}, root_ / "out", {});
  for (const char* mask : {"cam0/000000.png", "cam0/000001.png", "cam1/000001.png"}) {
    const cv::Mat read = cv::imread((root_ / "out/masks" / mask).string(), cv::IMREAD_UNCHANGED);
    EXPECT_EQ(read.type(), CV_8UC1);
    EXPECT_EQ(read.size(), cv::Size(160, 120));
    EXPECT_GT(cv::countNonZero(read), 100) << mask;
    EXPECT_LT(cv::countNonZero(read), 160 * 120 / 4) << mask;
  }
  const int lines = lines_of(root_ / "out/points.csv");
  EXPECT_EQ(lines % 2, 1);  // a heading
  EXPECT_GE(lines / 2, 200);
  EXPECT_LE(lines / 2, 400);
  EXPECT_EQ(text_of(root_ / "out/points.csv").rfind("t_s,id,x,y,z\n", 0), 0U);
  EXPECT_NE(text_of(root_ / "out/sequence.yaml").find("truth_points: points.csv\nmasks: masks\n"), std::string::npos);
}

TEST_F(WriterTest, TruthIsTheCameraInTheWorld) {
  const fs::path out = write("out", 3);
  const auto scene = make_simulated_scene("room", 3, {kCameras, kFrames, 0.25});
  std::ifstream in(out / "cam1.tum");
  std::string line;
  std::getline(in, line);
  for (int frame = 0; frame < kFrames; ++frame) {
    std::getline(in, line);
    std::istringstream fields(line);
    double t = 0, x = 0, y = 0, z = 0, qx = 0, qy = 0, qz = 0, qw = 0;
    fields >> t >> x >> y >> z >> qx >> qy >> qz >> qw;
    const Rigid3 expected = scene->cam_from_world(1, frame / 30.0).inverse();
    EXPECT_NEAR(t, frame / 30.0, 1e-9);
    EXPECT_NEAR((expected.translation - Eigen::Vector3d(x, y, z)).norm(), 0, 1e-8);
    EXPECT_NEAR(expected.rotation.angularDistance(Eigen::Quaterniond(qw, qx, qy, qz)), 0, 1e-7);
  }
}

TEST_F(WriterTest, TheSameSeedGivesTheSameBytes) {
  const fs::path a = write("a", 3), b = write("b", 3), other = write("c", 4);
  int compared = 0;
  for (const auto& entry : fs::recursive_directory_iterator(a)) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(text_of(entry.path()), text_of(b / fs::relative(entry.path(), a))) << entry.path();
    ++compared;
  }
  EXPECT_GT(compared, kFrames * kCameras);
  EXPECT_NE(text_of(a / "cam0/000000.png"), text_of(other / "cam0/000000.png"));
}

TEST_F(WriterTest, AFolderWithSomethingInItIsLeftAlone) {
  fs::create_directories(root_ / "mine");
  std::ofstream(root_ / "mine/notes.txt") << "keep";
  EXPECT_THROW(write("mine", 1), UserError);
  EXPECT_EQ(text_of(root_ / "mine/notes.txt"), "keep");
}

TEST_F(WriterTest, AnEmptyFolderIsFilled) {
  fs::create_directories(root_ / "empty");
  EXPECT_TRUE(fs::exists(write("empty", 1) / "sequence.yaml"));
}

TEST_F(WriterTest, AFailureLeavesNothingBehind) {
  std::ofstream(root_ / "file") << "not a folder";
  EXPECT_THROW(write("file/out", 1), UserError);
  int calls = 0;
  EXPECT_THROW(write("out", 1,
                     [&](int, int) {
                       if (++calls == 2) throw UserError("stopped");
                     }),
               UserError);
  EXPECT_EQ(std::distance(fs::directory_iterator(root_), {}), 1);
}

TEST_F(WriterTest, ACachedSequenceIsRenderedOnce) {
  ASSERT_EQ(setenv("COSLAM_CACHE", root_.c_str(), 1), 0);
  RenderOptions options;
  options.scene = "room";
  options.cameras = options.frames = 1;
  int calls = 0;
  const auto count = [&](int, int) { ++calls; };
  const fs::path first = cached_sequence(options, count);
  EXPECT_EQ(calls, 1);
  EXPECT_TRUE(fs::exists(first / "cam0/000000.png"));
  EXPECT_EQ(cached_sequence(options, count), first);
  EXPECT_EQ(calls, 1);
  unsetenv("COSLAM_CACHE");
}

}  // namespace
}  // namespace coslam::sim::writer_test
