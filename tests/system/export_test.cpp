// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A run, exported for viewers, as programs of others read it.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "common/dataset/result_folder.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam::export_test {
namespace {

TEST(ExportedRun, AnMcapFileIsReadByItsIndex) {
  constexpr int kNoNode = 77;
  const test::SmallScene scene(2, 60);
  const std::string result = (scene.folder() / "result").string(), out = (scene.folder() / "out").string();
  test::Program run("coslam", {"run", scene.sequence(), "--inline", "--out", result});
  ASSERT_EQ(run.exit_code(), 0) << run.err();
  test::Program exported("coslam", {"export", result, "--format", "mcap", out});
  ASSERT_EQ(exported.exit_code(), 0) << exported.err();
  const std::string command = std::string("bash " COSLAM_INTEROP "/run.sh " COSLAM_INTEROP_FOLDER " mcap_run.mjs ") +
                              out + "/run.mcap cam0 cam1";
  const int status = std::system(command.c_str());
  if (WEXITSTATUS(status) == kNoNode) GTEST_SKIP() << "no node, or none of its packages";
  EXPECT_EQ(status, 0);
}

// What COLMAP says, or nothing when it fails.
std::string colmap(const std::string& arguments) {
  FILE* said = popen(("QT_QPA_PLATFORM=offscreen colmap " + arguments + " 2>&1").c_str(), "r");
  std::string text;
  std::array<char, 4096> part{};
  while (std::fgets(part.data(), part.size(), said) != nullptr) text += part.data();
  return pclose(said) == 0 ? text : "";
}

// The number that follows the last `name` in a text.
double number_after(const std::string& text, const std::string& name) {
  const auto at = text.rfind(name);
  return at == std::string::npos ? NAN : std::atof(text.c_str() + at + name.size());
}

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// That COLMAP measures the error of each point as we do, and that its own adjustment, lenses included, finds little to
// improve.
void expect_colmap_agrees(const std::filesystem::path& model, const test::TempFolder& folder) {
  const std::string ours = text_of(model / "points3D.txt");
  const double points = number_after(ours, "Number of points: "), error_px = number_after(ours, "reprojection error: ");
  EXPECT_GT(points, 100);
  EXPECT_LT(error_px, 1);
  const std::string again = (folder / "again").string();
  std::filesystem::create_directories(again);
  // The model has our errors; COLMAP computes its own when it filters.
  colmap("point_filtering --min_track_len 2 --max_reproj_error 1000 --min_tri_angle 0 --input_path " + model.string() +
         " --output_path " + again);
  for (const std::string& of : {model.string(), again}) {
    const std::string said = colmap("model_analyzer --path " + of);
    EXPECT_EQ(number_after(said, "Points: "), points) << said;
    EXPECT_NEAR(number_after(said, "reprojection error: "), error_px, 0.05 * error_px) << said;
  }
  const std::string adjusted = colmap("bundle_adjuster --input_path " + model.string() + " --output_path " + again);
  const double before_px = number_after(adjusted, "Initial cost : "),
               after_px = number_after(adjusted, "Final cost : ");
  ASSERT_GT(before_px, 0) << adjusted;
  // It tells the root of the cost.
  EXPECT_GT(after_px * after_px, 0.95 * before_px * before_px) << adjusted;
}

TEST(ExportedRun, ColmapFindsNothingToMend) {
  if (colmap("help").empty()) GTEST_SKIP() << "there is no COLMAP (Debian package colmap)";
  const test::SmallScene scene(2, 60, DistortionModel::kRadTan, {-0.25, 0.06, 0.0004, -0.0003});
  const std::filesystem::path out = scene.folder() / "model";
  const std::string result = (scene.folder() / "result").string();
  test::Program run("coslam", {"run", scene.sequence(), "--inline", "--out", result});
  ASSERT_EQ(run.exit_code(), 0) << run.err();
  const std::vector<std::string> as_model = {"export", result, "--format", "colmap", "--sequence", scene.sequence()};
  for (const bool undistort : {false, true}) {
    SCOPED_TRACE(undistort ? "undistorted" : "as captured");
    auto arguments = as_model;
    arguments.push_back(out);
    if (undistort) arguments.emplace_back("--undistort");
    test::Program exported("coslam", arguments);
    ASSERT_EQ(exported.exit_code(), 0) << exported.err();
    expect_colmap_agrees(undistort ? out / "sparse" : out, scene.folder());
  }
  EXPECT_NE(text_of(out / "sparse/0/cameras.txt").find("1 PINHOLE "), std::string::npos);
  const std::string image = "images/cam1/" + std::filesystem::path(scene.image(1, 50)).filename().string();
  for (const std::string& file :
       {std::string("images/cam0/000000.png"), image, std::string("sparse/0/points3D.txt"),
        std::string("stereo/fusion.cfg"), std::string("stereo/patch-match.cfg"), std::string("stereo/depth_maps/cam1")})
    EXPECT_TRUE(std::filesystem::exists(out / file)) << file;
}

}  // namespace
}  // namespace coslam::export_test
