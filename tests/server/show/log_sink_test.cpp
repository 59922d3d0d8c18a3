// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/log_sink.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/log.h"

namespace coslam::log_sink_test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(LogSink, SaysWhatHappensButNotWhoComesAndGoes) {
  Snapshot snapshot;
  snapshot.events = {{1, "lost", "cam1 is lost: too few points", {"cam1"}},
                     {2, "merge", "cam0 and cam1 share a view now", {"cam0", "cam1"}},
                     {3, "joined", "cam2 joined", {"cam2"}}};
  testing::internal::CaptureStderr();
  init_log("server", LogFormat::kJson);
  LogSink().see(snapshot);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, HasSubstr(R"("level":"warning","program":"server","text":"cam1 is lost: too few points")"));
  EXPECT_THAT(said, HasSubstr(R"("level":"info","program":"server","text":"cam0 and cam1 share a view now")"));
  EXPECT_THAT(said, Not(HasSubstr("cam2 joined")));
}

}  // namespace
}  // namespace coslam::log_sink_test
