// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/outcome.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "common/base/error.h"
#include "common/dataset/result.h"
#include "tests/support/temp_folder.h"

namespace coslam::outcome_test {
namespace {

using testing::HasSubstr;
using testing::Not;

class OutcomeTest : public testing::Test {
 protected:
  OutcomeTest() {
    report_["agents"]["a"] = {
        {"frames", 300}, {"tracked_percent", 99.5}, {"path", {{"quality", "fair"}, {"why", "few"}}}};
    report_["agents"]["b"] = {{"frames", 300}};
    report_["server"]["events"] = {{"images_described", 7}};
    report_["maps"] = {{{"map", 1}, {"agents", {{"a", 298}}}}};
  }
  std::string summary() {
    std::ofstream(ResultFolder(folder_.path()).report()) << report_.dump();
    testing::internal::CaptureStdout();
    mapped_ = print_summary(folder_.path());
    return testing::internal::GetCapturedStdout();
  }

  const test::TempFolder folder_;
  nlohmann::json report_;
  bool mapped_ = false;
};

TEST_F(OutcomeTest, EachAgentHasALineAndAPathThatIsNotGoodAReason) {
  const std::string text = summary();
  EXPECT_TRUE(mapped_);
  EXPECT_THAT(text, HasSubstr("a                300     99.5%"));
  EXPECT_THAT(text, HasSubstr("a: its path is fair, as few\n"));
  EXPECT_THAT(text, HasSubstr("\nb "));
  EXPECT_THAT(text, Not(HasSubstr("brought together")));
}

TEST_F(OutcomeTest, MapsThatWereNotJoinedAreNamedWithTheReasons) {
  report_["maps"].push_back({{"map", 4}, {"agents", {{"b", 250}}}});
  EXPECT_THAT(summary(), HasSubstr("2 maps, which could not be brought together"));
  EXPECT_THAT(summary(), HasSubstr("  maps/4: b (250 frames)\n"));
  EXPECT_THAT(summary(), HasSubstr("7 images were compared with known places; not believed: none, as no place was"));
  report_["server"]["events"]["places_flat"] = 2;
  report_["server"]["events"]["places_unconfirmed"] = 1;
  EXPECT_THAT(summary(), HasSubstr("2 on one flat thing alone, 1 without a second image that confirms\n"));
}

TEST_F(OutcomeTest, ARunThatMappedNothingSaysWhyOnStandardError) {
  report_["problem"] = "no agent came";
  testing::internal::CaptureStderr();
  summary();
  EXPECT_FALSE(mapped_);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "coslam: no agent came\n");
}

TEST_F(OutcomeTest, ARunIsReplacedOnlyWhenForced) {
  make_result_folder(folder_.path() / "new" / "deep", false);
  EXPECT_TRUE(std::filesystem::is_directory(folder_.path() / "new" / "deep"));
  EXPECT_THROW(make_result_folder("", false), UsageError);
  summary();
  EXPECT_THROW(make_result_folder(folder_.path(), false), UserError);
  make_result_folder(folder_.path(), true);
  EXPECT_FALSE(std::filesystem::exists(ResultFolder(folder_.path()).report()));
}

}  // namespace
}  // namespace coslam::outcome_test
