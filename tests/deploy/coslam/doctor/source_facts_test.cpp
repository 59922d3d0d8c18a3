// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "common/base/log.h"
#include "deploy/coslam/doctor/camera.h"
#include "tests/support/synthetic_view.h"
#include "tests/support/temp_folder.h"

namespace coslam::doctor::source_facts_test {
namespace {

using coslam::test::plane_texture;
using coslam::test::render;
using coslam::test::View;
using ::testing::HasSubstr;

const cv::Size kSize(320, 240);

// A folder of a few images at ten a second.
class LookAtSource : public ::testing::Test {
 protected:
  LookAtSource() {
    settings_.source = (folder_ / "shot").string();
    settings_.play.rate_hz = 10;
    settings_.agent.tracker.device = "cpu";
    std::filesystem::create_directories(folder_ / "shot");
  }
  // Of a camera that moves to the right. change: what is wrong about the images.
  void write_images(
      int count, const std::function<void(cv::Mat&)>& change = [](cv::Mat&) {}) const {
    static const cv::Mat texture = plane_texture(500, 320, 4);
    for (int i = 0; i < count; ++i) {
      cv::Mat image = render(texture, View::at({200.0 + 3 * i, 150}, 0, 1, kSize), kSize);
      change(image);
      cv::imwrite((folder_ / ("shot/" + std::to_string(100 + i) + ".png")).string(), image);
    }
  }

  // All of it, however slow the machine is.
  SourceFacts look() const { return look_at_source(settings_, std::chrono::minutes(1)); }

  const LogPause quiet_;
  const coslam::test::TempFolder folder_;
  AgentOptions settings_;
};

TEST_F(LookAtSource, ImagesAreCountedAndTracked) {
  write_images(5);
  const SourceFacts facts = look();
  EXPECT_EQ(facts.problem, "");
  EXPECT_EQ(facts.calibration_problem, "");
  EXPECT_FALSE(facts.live);
  EXPECT_EQ(facts.images, 5);
  EXPECT_EQ(facts.width_px, 320);
  EXPECT_EQ(facts.height_px, 240);
  EXPECT_NEAR(facts.period_s, 0.1, 1e-6);
  EXPECT_NEAR(facts.longest_s, 0.1, 1e-6);
  EXPECT_EQ(facts.nominal_hz, 10);
  EXPECT_EQ(facts.behind_s, 0) << "no clock is behind a file";
  EXPECT_GT(facts.tracks, 50);
  EXPECT_EQ(facts.most_tracks, settings_.agent.tracker.max_tracks);
  EXPECT_GT(facts.track_s, 0);
  EXPECT_EQ(facts.at_fault, 0);
}

TEST_F(LookAtSource, LightAndFocusAreThoseOfTheImages) {
  write_images(3);
  const SourceFacts fine = look();
  write_images(3, [](cv::Mat& image) { cv::GaussianBlur(image, image, cv::Size(), 4); });
  const SourceFacts soft = look();
  EXPECT_LT(soft.sharpness, 0.2 * fine.sharpness);
  EXPECT_NEAR(soft.light, fine.light, 3);
  write_images(3, [](cv::Mat& image) { image.convertTo(image, -1, 0.5, 0); });
  const SourceFacts dim = look();
  EXPECT_NEAR(dim.light, fine.light / 2, 1);
  EXPECT_GT(dim.sharpness, 0.9 * fine.sharpness) << "less light is no less sharp";
  write_images(3, [](cv::Mat& image) { image.convertTo(image, -1, 4, -200); });
  EXPECT_GT(look().clipped, fine.clipped + 0.2);
}

TEST_F(LookAtSource, ASourceThatIsNotThereIsAProblem) {
  settings_.source = (folder_ / "nowhere").string();
  const SourceFacts facts = look();
  EXPECT_THAT(facts.problem, HasSubstr("nowhere"));
  EXPECT_EQ(facts.images, 0);
  EXPECT_EQ(facts.name, settings_.source);
}

TEST_F(LookAtSource, ACalibrationThatCannotBeReadLeavesTheRest) {
  write_images(3);
  settings_.calibration = folder_.write("calib.yaml", "hello: world\n").string();
  const SourceFacts facts = look();
  EXPECT_THAT(facts.calibration_problem, HasSubstr("not a calibration"));
  EXPECT_EQ(facts.problem, "");
  EXPECT_EQ(facts.images, 3);
}

TEST_F(LookAtSource, ALensThatIsUnlikelyIsDoubted) {
  write_images(3);
  const std::string lens = "width: 320\nheight: 240\nfx: 250\nfy: 250\ncy: 119.5\n";
  settings_.calibration = folder_.write("calib.yaml", lens + "cx: 159.5\n").string();
  EXPECT_EQ(look().doubt, "");
  settings_.calibration = folder_.write("calib.yaml", lens + "cx: 300\n").string();
  const SourceFacts facts = look();
  EXPECT_EQ(facts.calibration_problem, "");
  EXPECT_THAT(facts.doubt, HasSubstr("principal point"));
}

TEST_F(LookAtSource, OneImageHasNoPace) {
  write_images(1);
  const SourceFacts facts = look();
  EXPECT_EQ(facts.images, 1);
  EXPECT_EQ(facts.period_s, 0);
  EXPECT_EQ(facts.longest_s, 0);
}

}  // namespace
}  // namespace coslam::doctor::source_facts_test
