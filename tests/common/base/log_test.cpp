// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/log.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace coslam::log_test {
namespace {

std::string logged(LogFormat format) {
  testing::internal::CaptureStderr();
  init_log("cam\"0", format);
  log_warn("a \"word\"\tand \xff, which is no UTF-8");
  return testing::internal::GetCapturedStderr();
}

TEST(Log, ALineOfTextHasTimeNameAndLevel) {
  EXPECT_THAT(logged(LogFormat::kText), testing::ContainsRegex("^[0-9:.]+ cam\"0 warning: a \"word\"\tand "));
}

TEST(Log, ALineOfJsonIsAnObjectWhateverItSays) {
  const auto line = nlohmann::json::parse(logged(LogFormat::kJson));
  EXPECT_EQ(line.size(), 4U);
  EXPECT_EQ(line["program"], "cam\"0");
  EXPECT_EQ(line["level"], "warning");
  EXPECT_THAT(line["time"], testing::ContainsRegex("^20[0-9][0-9]-[0-9-]+T[0-9:.]+Z$"));
  EXPECT_THAT(line["text"], testing::StartsWith("a \"word\"\tand "));
}

TEST(Log, WarningsThatDifferInTheirFiguresAreOne) {
  log_warn("7 sets of cam1 were left out");
  log_warn("9 sets of cam1 were left out");
  log_warn("9 sets of cam2 were left out");
  {
    const LogPause pause;
    log_warn("not said");
  }
  std::vector<Warning> all = warnings_given();
  std::erase_if(all, [](const Warning& w) { return w.text.find("sets") == std::string::npos && w.text != "not said"; });
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].text, "9 sets of cam1 were left out");
  EXPECT_EQ(all[0].count, 2);
  EXPECT_EQ(all[1].text, "9 sets of cam2 were left out");
}

}  // namespace
}  // namespace coslam::log_test
