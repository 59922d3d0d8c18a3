// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/fleet/fleet_files.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "agent/agent_options.h"
#include "common/base/error.h"
#include "common/config/config.h"
#include "common/wire/guard.h"
#include "server/app/server_options.h"
#include "tests/support/temp_folder.h"

namespace coslam::fleet_files_test {
namespace {

using ::testing::HasSubstr;

const FleetPlan kPlan{.agents = {"left", "right"}, .server = "base.local", .domain = 7};

TEST(FleetFiles, AreReadByThePrograms) {
  const test::TempFolder folder;
  write_files(folder.path(), fleet_files(kPlan, draw_secret()), false);
  ServerOptions server;
  config::load(server, folder / "server/server.yaml");
  EXPECT_EQ(server.wire.domain, 7);
  EXPECT_TRUE(server.wire.peers.empty());
  AgentOptions agent;
  config::load(agent, folder / "agents/right/agent.yaml");
  EXPECT_EQ(agent.id, "right");
  EXPECT_EQ(agent.source, "v4l2:0");
  EXPECT_EQ(agent.calibration, "");
  EXPECT_EQ(agent.wire.domain, 7);
  EXPECT_THAT(agent.wire.peers, ::testing::ElementsAre("base.local"));
  EXPECT_EQ(agent.wire.key_file, "/etc/coslam/fleet.key");
  EXPECT_NO_THROW(load_fleet_key((folder / "fleet.key").string(), 7));  // of the right length, and its owner's alone
}

TEST(FleetFiles, KeysDiffer) { EXPECT_NE(draw_secret(), draw_secret()); }

TEST(FleetFiles, NothingIsReplacedUnasked) {
  const test::TempFolder folder;
  write_files(folder.path(), fleet_files(kPlan, "first\n"), false);
  try {
    write_files(folder.path(), fleet_files(kPlan, "second\n"), false);
    FAIL();
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("fleet.key is there already"));
  }
  chmod((folder / "fleet.key").c_str(), 0644);
  write_files(folder.path(), fleet_files(kPlan, "second\n"), true);
  struct stat status {};
  ASSERT_EQ(stat((folder / "fleet.key").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
}

TEST(FleetFiles, NamesOfAgents) {
  EXPECT_THROW(fleet_files({.agents = {"a b"}}, "s"), UsageError);
  EXPECT_THROW(fleet_files({.agents = {"a", "a"}}, "s"), UsageError);
}

TEST(FleetFiles, NameOfTheServer) {
  FleetPlan plan = kPlan;
  plan.server = "no such host";
  EXPECT_THROW(fleet_files(plan, "secret\n"), UsageError);
}

TEST(FleetFiles, WhatComesNext) {
  const std::string text = next_commands(kPlan, "fleet");
  EXPECT_THAT(text, HasSubstr("scp fleet/fleet.key fleet/server/server.yaml root@base.local:/etc/coslam/\n"));
  EXPECT_THAT(text, HasSubstr("scp fleet/fleet.key fleet/agents/left/agent.yaml root@left:/etc/coslam/\n"));
  EXPECT_THAT(text, HasSubstr("systemctl enable --now coslam-agent'"));
  EXPECT_THAT(text, HasSubstr("coslam doctor --domain 7 --key fleet/fleet.key\n"));
}

}  // namespace
}  // namespace coslam::fleet_files_test
