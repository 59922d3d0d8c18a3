// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "agent/agent_options.h"
#include "common/config/config.h"
#include "server/app/server_options.h"
#include "server/show/bridge/bridge_config.h"

// The commented files in deploy/config say what the defaults are.
namespace coslam::config_files_test {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(COSLAM_SOURCE) / "deploy/config";

template <class Options>
void expect_defaults(const std::filesystem::path& file) {
  Options options;
  config::load(options, file);
  EXPECT_EQ(config::dump_json(options).dump(1), config::dump_json(Options()).dump(1)) << file;
}

TEST(ConfigFiles, HoldTheDefaults) {
  expect_defaults<ServerOptions>(kFolder / "server.yaml");
  expect_defaults<AgentOptions>(kFolder / "agent.yaml");
  expect_defaults<BridgeOptions>(kFolder / "bridge.yaml");
}

}  // namespace
}  // namespace coslam::config_files_test
