// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/camera_of.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/base/error.h"
#include "common/dataset/calibration.h"
#include "tests/support/temp_folder.h"

namespace coslam::camera_of_test {
namespace {

class CameraOf : public ::testing::Test {
 protected:
  CameraOf() {
    for (const char* name : {"000000.png", "000001.png"}) {
      cv::imwrite(folder_ / name, cv::Mat(48, 64, CV_8UC1, cv::Scalar(7)));
    }
  }
  std::string source() const { return folder_.path().string(); }
  test::TempFolder folder_;
};

TEST_F(CameraOf, IsTheCalibrationWhereThereIsOne) {
  const CameraModel given{64, 48, 50, 51, 31, 23, DistortionModel::kNone, {}};
  save_calibration(folder_ / "calib.yaml", given);
  const FoundCamera found = camera_of(source(), folder_ / "calib.yaml", {});
  EXPECT_EQ(found.camera, given);
  EXPECT_EQ(found.guess, "");
}

TEST_F(CameraOf, IsElseGuessedFromTheSizeOfTheFirstImage) {
  const auto [guess, said] = camera_of(source(), "", {});
  EXPECT_THAT(said, ::testing::HasSubstr("a focal length of 51 px as cameras of phones"));
  EXPECT_EQ(guess.width_px, 64);
  EXPECT_EQ(guess.height_px, 48);
  EXPECT_EQ(guess.distortion, DistortionModel::kUnknown);
  EXPECT_FALSE(problem_of(guess));
  save_calibration(folder_ / "guess.yaml", guess);
  EXPECT_EQ(load_calibration(folder_ / "guess.yaml"), guess) << "it may be written down";
}

TEST_F(CameraOf, IsGuessedWhereNoLensIsAsTheCalibrationSays) {
  save_calibration(folder_ / "calib.yaml", {64, 48, 50, 51, 62, 23, DistortionModel::kNone, {}});
  const FoundCamera found = camera_of(source(), folder_ / "calib.yaml", {});
  EXPECT_EQ(found.camera, guessed_camera(64, 48));
  EXPECT_THAT(found.guess,
              ::testing::HasSubstr("another size? It is left aside, and the lens found out from the images, "
                                   "from a focal length of 51 px on"));
}

TEST_F(CameraOf, IsNotThatOfHalfAPicture) {
  save_calibration(folder_ / "calib.yaml", {32, 48, 50, 51, 15, 23, DistortionModel::kNone, {}});
  try {
    open_camera(source(), folder_ / "calib.yaml", {});
    ADD_FAILURE() << "it is twice as wide";
  } catch (const UserError& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("two pictures side by side, make two sources of it"));
  }
}

TEST_F(CameraOf, IsTheCalibrationWhereThatIsOnlyUnusual) {
  const CameraModel given{64, 48, 50, 68, 31, 23, DistortionModel::kNone, {}};
  save_calibration(folder_ / "calib.yaml", given);
  const FoundCamera found = camera_of(source(), folder_ / "calib.yaml", {});
  EXPECT_EQ(found.camera, given);
  EXPECT_THAT(found.guess, ::testing::HasSubstr("fx 50.0 and fy 68.0 px, are far apart"));
}

TEST_F(CameraOf, NamesASourceThatIsNotThere) {
  EXPECT_THAT(test::error_of<UserError>([&] { camera_of((folder_ / "nowhere").string(), "", {}); }),
              ::testing::HasSubstr("nowhere"));
}

}  // namespace
}  // namespace coslam::camera_of_test
