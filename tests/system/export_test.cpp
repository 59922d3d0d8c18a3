// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A run, exported for viewers, as programs of others read it.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "common/dataset/result_folder.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam {
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

}  // namespace
}  // namespace coslam
