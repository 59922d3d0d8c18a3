// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/report_parts.h"

#include <gtest/gtest.h>

namespace coslam::report_parts_test {
namespace {

TEST(ReportParts, AccountsOfImagesAreReadAsWritten) {
  ImageAccount images;
  for (std::size_t i = 0; i < kImageFates; ++i) images.images[i] = 10 * i;
  const nlohmann::json agent{{"images", json_of(images)}};
  EXPECT_EQ(agent["images"]["captured"], images.captured());
  EXPECT_EQ(images_of(agent), images);
  EXPECT_EQ(images_of(nlohmann::json()), ImageAccount()) << "a report of before they were counted";
  EXPECT_EQ(images_of({{"images", {{"tracked", "many"}}}}), ImageAccount());
}

TEST(ReportParts, WarningsAreReadAsWritten) {
  const nlohmann::json report{{"warnings", json_of(std::vector<Warning>{{"cam1 is lost", 3}, {"a \xff file", 1}})}};
  const std::vector<Warning> read = warnings_of(report);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].text, "cam1 is lost");
  EXPECT_EQ(read[0].count, 3);
  EXPECT_EQ(read[1].text, "a \xEF\xBF\xBD file") << "JSON is UTF-8";
  EXPECT_TRUE(warnings_of({{"warnings", {1, {{"text", 2}}}}}).empty());
}

}  // namespace
}  // namespace coslam::report_parts_test
