// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Recordings of earlier versions: two cameras in a room, 45 frames each. Of another protocol they are refused.
#include <gmock/gmock.h>

#include "common/base/error.h"
#include "common/model/session.h"
#include "server/fleet/record/recording.h"
#include "tests/support/kept_files.h"
#include "tests/support/temp_folder.h"

namespace coslam::recording_versions_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class RecordingVersions : public testing::TestWithParam<int> {
 protected:
  RecordingVersions() { test::unpack_kept("recording_protocol_" + std::to_string(GetParam()) + ".rec", file_); }

  const test::TempFolder folder_;
  const std::filesystem::path file_ = folder_ / "kept.rec";
};

INSTANTIATE_TEST_SUITE_P(All, RecordingVersions, testing::Values(12, 14));

TEST_P(RecordingVersions, IsReadOrRefusedWithBothNumbers) {
  if (GetParam() == kProtocolVersion) {
    const RecordingSummary read = check_recording(file_);
    EXPECT_FALSE(read.cut_off);
    EXPECT_EQ(read.head.version, "0.1.0");
    return;
  }
  EXPECT_THAT(test::error_of<UserError>([&] { check_recording(file_); }),
              AllOf(HasSubstr("kept.rec has messages of protocol " + std::to_string(GetParam())),
                    HasSubstr("this program reads protocol " + std::to_string(kProtocolVersion))));
}

}  // namespace
}  // namespace coslam::recording_versions_test
