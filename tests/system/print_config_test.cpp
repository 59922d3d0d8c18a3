// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// --print-config of the programs: what they print is a file for --config that says the same.
#include <gmock/gmock.h>

#include "tests/support/temp_folder.h"
#include "tests/system/program.h"

namespace coslam::print_config_test {
namespace {

using test::Program;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

std::string printed(const std::string& program, std::vector<std::string> arguments) {
  arguments.emplace_back("--print-config");
  Program run(program, std::move(arguments));
  EXPECT_EQ(run.exit_code(), 0) << run.err();
  EXPECT_THAT(run.err(), IsEmpty());
  return run.out();
}

TEST(PrintConfig, Server) {
  const test::TempFolder folder;
  const std::string file =
      folder.write("server.yaml", "agents: [left, right]\nserver: {theta: 2.5, tag_m: 0.1}\n").string();
  const std::string all = printed("coslam-server", {"--config", file, "--set", "server.tag_m=0.16", "--domain", "7"});
  EXPECT_THAT(all, StartsWith("# All keys of coslam-server"));
  EXPECT_THAT(all, HasSubstr("agents: [\"left\", \"right\"]  # "));
  EXPECT_THAT(all, HasSubstr("  theta: 2.5  # Mahalanobis gate (0.5 to 10)\n"));
  EXPECT_THAT(all, HasSubstr("  tag_m: 0.16  # "));
  EXPECT_THAT(all, HasSubstr("  domain: 7  # "));
  EXPECT_EQ(printed("coslam-server", {"--config", folder.write("all.yaml", all).string()}), all);
}

TEST(PrintConfig, Bridge) {
  const test::TempFolder folder;
  const std::string all = printed("coslam-bridge", {"--from", "7", "--domain", "3", "--px4", "left", "--interface",
                                                    "10.0.0.5", "--set", "bridge.px4.pitch_deg=-30"});
  EXPECT_THAT(all, StartsWith("# All keys of coslam-bridge"));
  EXPECT_THAT(all, HasSubstr("  domain: 7  # "));
  EXPECT_THAT(all, HasSubstr("  domain: 3  # "));
  EXPECT_THAT(all, HasSubstr("    pitch_deg: -30  # "));
  EXPECT_EQ(printed("coslam-bridge", {"--config", folder.write("all.yaml", all).string()}), all);
}

TEST(PrintConfig, Agent) {
  const test::TempFolder folder;
  const std::string source = "gst:videotestsrc ! video/x-raw,width=640 name=\"a # b\"";
  const std::string all =
      printed("coslam-agent", {"--id", "left", "--source", source, "--calibration", "it's.yaml", "--rate", "2",
                               "--start", "0.1", "--set", "agent.tracker.max_tracks=200"});
  EXPECT_THAT(all, StartsWith("# All keys of coslam-agent"));
  EXPECT_THAT(all, HasSubstr("rate: \"2\"  # "));
  EXPECT_THAT(all, HasSubstr("start_s: 0.1  # "));
  EXPECT_THAT(all, HasSubstr("    max_tracks: 200  # features followed at once (20 to 1024)\n"));
  EXPECT_EQ(printed("coslam-agent", {"--config", folder.write("all.yaml", all).string()}), all);
}

// Values that no file may hold are refused before they are printed.
TEST(PrintConfig, OptionsKeepTheBoundsOfTheirKeys) {
  Program start("coslam-agent", {"--start", "-4000", "--print-config"});
  EXPECT_EQ(start.exit_code(), 2) << start.err();
  EXPECT_THAT(start.err(), HasSubstr("--start"));
  Program rate("coslam-agent", {"--fps", "0", "--print-config"});
  EXPECT_EQ(rate.exit_code(), 2) << rate.err();
  EXPECT_THAT(rate.err(), HasSubstr("--fps"));
}

}  // namespace
}  // namespace coslam::print_config_test
