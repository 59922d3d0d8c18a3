// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "common/base/error.h"
#include "common/dataset/calibration.h"
#include "tests/support/temp_folder.h"

namespace coslam::test {

// Loads calibrations from their text.
class CalibrationFiles : public testing::Test {
 protected:
  CameraModel load(const std::string& text, const std::string& camera = "") {
    return load_calibration(folder_.write("calib.yaml", text).string() + (camera.empty() ? "" : "#" + camera));
  }
  std::string error(const std::string& text, const std::string& camera = "") {
    return error_of<UserError>([&] { load(text, camera); });
  }
  TempFolder folder_;
};

}  // namespace coslam::test
