// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// One agent with the fleet's key lies (liar.cpp); two beside it do not.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "common/dataset/result.h"
#include "common/dataset/trajectory.h"
#include "tests/support/test_domain.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam::liar_test {
namespace {

using nlohmann::json;
using test::Program;
using test::SmallScene;

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class Lies : public ::testing::Test {
 protected:
  struct Outcome {
    json report;
    double ate_m = 0;
    std::size_t poses = 0;  // of the agent that has fewest
    std::string trajectories;
  };

  Lies() {
    std::filesystem::permissions(key_, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write,
                                 std::filesystem::perm_options::replace);
  }

  // The agents at that rate; liar: its pacing, empty for none.
  Outcome run(const std::string& rate, const std::string& liar) {
    const std::filesystem::path out = scene_.folder() / ("result-" + std::to_string(++runs_));
    const std::string names = liar.empty() ? "agents=cam0,cam1" : "agents=cam0,cam1,liar";
    Program server("coslam-server",
                   {"--loopback", "--domain", domain(), "--out", out.string(), "--set", key(), "--set", names});
    std::optional<Program> lying;
    if (!liar.empty()) lying.emplace("../test/liar", std::vector{domain(), key_.string(), liar});
    Program a("coslam-agent", agent(0, rate)), b("coslam-agent", agent(1, rate));
    if (lying) {
      EXPECT_TRUE(lying->prints("joined")) << server.err();
    }
    for (Program* agent : {&a, &b}) EXPECT_EQ(agent->exit_code(), 0) << agent->err();
    for (const char* name : {"cam0", "cam1"}) {
      EXPECT_TRUE(server.says("agent " + std::string(name) + " has ended")) << server.err();
    }
    lying.reset();
    EXPECT_EQ(server.exit_code(), 0) << server.err();
    return outcome_of(out);
  }

  const SmallScene scene_{2, 300};

 private:
  Outcome outcome_of(const std::filesystem::path& out) const {
    const ResultFolder result = find_result(out);
    Outcome o{.report = read_json(result.report()), .poses = SIZE_MAX};
    for (const char* name : {"cam0", "cam1"}) {
      o.poses = std::min(o.poses, load_tum(result.trajectory(name)).size());
      o.trajectories += content(result.trajectory(name));
    }
    Program eval("coslam", {"eval", out.string(), scene_.sequence()});
    EXPECT_EQ(eval.exit_code(), 0) << eval.err();
    const json evaluation = read_json(result.evaluation());
    o.ate_m = evaluation["ate_m"].is_number() ? evaluation["ate_m"].get<double>() : std::nan("");
    return o;
  }

  std::vector<std::string> agent(int camera, const std::string& rate) const {
    std::vector<std::string> arguments = scene_.agent(camera, domain(), rate);
    arguments.insert(arguments.end(), {"--set", key()});
    return arguments;
  }
  std::string domain() const { return std::to_string(domain_.number()); }
  std::string key() const { return "wire.key_file=" + key_.string(); }

  int runs_ = 0;
  const test::TestDomain domain_;
  const std::filesystem::path key_ = scene_.folder().write("fleet.key", "a secret of sixteen");
};

// In lock-step, where runs can be compared to the bit.
TEST_F(Lies, WhatCanBeToldToBeWrongChangesNothing) {
  const Outcome alone = run("max", "quiet"), beside = run("max", "lockstep");
  EXPECT_EQ(beside.trajectories, alone.trajectories);
  EXPECT_EQ(beside.ate_m, alone.ate_m);
  const json& rejected = beside.report["rejected"];
  for (const char* reason : {"not_finite", "bad_rotation", "out_of_range", "too_many", "malformed", "size_mismatch",
                             "bad_text", "wrong_run", "missing_reference"}) {
    EXPECT_GT(rejected.value(reason, 0), 0) << reason << "\n" << rejected;
  }
}

// In real time, with frames of nothing, of every time there is, and ten times as many as announced. What that costs the
// others is a matter of the machine: see docs/field.md.
TEST_F(Lies, WhatCannotBeToldIsThinned) {
  const Outcome alone = run("1", ""), beside = run("1", "live");
  RecordProperty("ate_m_alone", std::to_string(alone.ate_m));
  RecordProperty("poses_alone", static_cast<int>(alone.poses));
  EXPECT_GT(beside.poses, 0U);
  EXPECT_GT(beside.report["frames_out_of_time"], 1000);
  EXPECT_LT(beside.report["frame_sets"], 1000) << "in ten seconds, of 3000 frames";
  EXPECT_GT(beside.report["rejected"]["wrong_run"], 100) << "another's name and run, and further names";
  for (const char* other : {"name0", "name199", "nobody"}) EXPECT_FALSE(beside.report["agents"].contains(other));
  RecordProperty("ate_m", std::to_string(beside.ate_m));
  RecordProperty("poses", static_cast<int>(beside.poses));
}

}  // namespace
}  // namespace coslam::liar_test
