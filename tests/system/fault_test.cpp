// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Processes that are killed or come late: the others go on, and somebody says what happened.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "common/dataset/result.h"
#include "common/dataset/trajectory.h"
#include "tests/support/test_domain.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam::fault_test {
namespace {

using test::lines_with;
using test::Program;
using test::SmallScene;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr int kFrames = 200;

class Fault : public ::testing::Test {
 protected:
  std::vector<std::string> run() const {
    return {"run", scene_.sequence(), "--out", result_.path().string(), "--domain", domain()};
  }
  std::vector<std::string> server() const { return {"--loopback", "--domain", domain(), "--out", runs_.string()}; }
  ResultFolder latest() const { return find_result(runs_); }
  std::vector<std::string> agent(int camera) const { return scene_.agent(camera, domain()); }
  std::string domain() const { return std::to_string(domain_.number()); }

  const SmallScene scene_{2, kFrames};
  const ResultFolder result_{scene_.folder() / "result"};
  const std::filesystem::path runs_ = scene_.folder() / "runs";
  const test::TestDomain domain_;
};

TEST_F(Fault, KilledAgentLeavesTheOthersAtWork) {
  Program run("coslam", this->run());
  ASSERT_TRUE(run.says("agent cam1 joined")) << run.err();
  const pid_t victim = run.child_with({"coslam-agent", "cam1"});
  ASSERT_GT(victim, 0);
  kill(victim, SIGKILL);
  EXPECT_EQ(run.exit_code(), 1) << run.err();
  EXPECT_THAT(lines_with(run.err(), "coslam run: "), SizeIs(1)) << run.err();
  EXPECT_THAT(run.err(), HasSubstr("coslam run: agent cam1 was killed by signal 9; the others went on without it\n"));
  EXPECT_EQ(load_tum(result_.trajectory("cam0")).size(), static_cast<std::size_t>(kFrames));
  EXPECT_LT(load_tum(result_.trajectory("cam1")).size(), static_cast<std::size_t>(kFrames));
}

TEST_F(Fault, KilledServerEndsTheRun) {
  Program run("coslam", this->run());
  ASSERT_TRUE(run.says("agent cam1 joined")) << run.err();
  kill(run.child_with({"coslam-server"}), SIGKILL);
  EXPECT_EQ(run.exit_code(), 1);
  EXPECT_THAT(lines_with(run.err(), "coslam run: "), SizeIs(1)) << run.err();
  EXPECT_THAT(run.err(), HasSubstr("coslam run: the map server was killed by signal 9\n"));
}

TEST_F(Fault, KilledServerEndsReplayingAgents) {
  Program server("coslam-server", this->server());
  Program a("coslam-agent", agent(0)), b("coslam-agent", agent(1));
  for (Program* agent : {&a, &b}) ASSERT_TRUE(agent->says("info: playing ")) << agent->err();
  server.signal(SIGKILL);
  for (Program* agent : {&a, &b}) {
    EXPECT_EQ(agent->exit_code(), 1) << agent->err();
    EXPECT_THAT(lines_with(agent->err(), "coslam-agent: the map server no longer answers"), SizeIs(1)) << agent->err();
  }
}

// Agents play on in real time; the second server has the first one's map, and the tracks in it.
TEST_F(Fault, KilledServerGoesOnWithItsMap) {
  using std::chrono::steady_clock;
  const SmallScene scene(2, 450);
  const std::string map = (scene.folder() / "kept.map").string();
  std::vector<std::string> words = server();
  for (const char* word : {"--map", map.c_str(), "--set", "server.map_file.period_s=0.2"}) words.emplace_back(word);
  Program first("coslam-server", words);
  Program a("coslam-agent", scene.agent(0, domain(), "1")), b("coslam-agent", scene.agent(1, domain(), "1"));
  ASSERT_TRUE(a.says("info: playing ")) << a.err();
  const auto begin = steady_clock::now();
  const auto played_s = [&] { return std::chrono::duration<double>(steady_clock::now() - begin).count(); };
  for (Program* agent : {&a, &b}) ASSERT_TRUE(agent->says("has a pose in the map")) << agent->err();
  // The agents play with the clock; their stamps begin up to half a second before they say that they play.
  while (played_s() < 2.5) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  first.signal(SIGKILL);
  const double killed_s = played_s();
  EXPECT_EQ(first.exit_code(), 128 + SIGKILL);
  Program second("coslam-server", words);
  ASSERT_TRUE(second.says("going on with the map of ")) << second.err();
  for (Program* agent : {&a, &b}) EXPECT_EQ(agent->exit_code(), 0) << agent->err();
  ASSERT_TRUE(second.says("agent cam0 has ended")) << second.err();
  ASSERT_TRUE(second.says("agent cam1 has ended")) << second.err();
  second.signal(SIGINT);
  EXPECT_EQ(second.exit_code(), 0) << second.err();
  for (const char* name : {"cam0", "cam1"}) {
    const Trajectory path = load_tum(latest().trajectory(name));
    ASSERT_FALSE(path.empty()) << name;
    EXPECT_LT(to_seconds(path.front().t_ns), killed_s) << "of the first server's time";
    EXPECT_GT(to_seconds(path.back().t_ns), killed_s + 1) << "of the second one's";
  }
}

TEST_F(Fault, InterruptedServerWritesTheResultAndEndsReplayingAgents) {
  Program server("coslam-server", this->server());
  Program a("coslam-agent", agent(0)), b("coslam-agent", agent(1));
  for (Program* agent : {&a, &b}) ASSERT_TRUE(agent->says("info: playing ")) << agent->err();
  server.signal(SIGINT);
  EXPECT_EQ(server.exit_code(), 0) << server.err();
  EXPECT_EQ(a.exit_code(), 0) << a.err();
  EXPECT_EQ(b.exit_code(), 0) << b.err();
  EXPECT_EQ(read_json(latest().report())["adjusted"], true);
}

TEST_F(Fault, EachServerHasAFolderOfItsOwn) {
  for (int run = 0; run < 2; ++run) {
    Program server("coslam-server", this->server());
    Program a("coslam-agent", agent(0));
    ASSERT_TRUE(a.says("info: playing ")) << a.err();
    server.signal(SIGINT);
    EXPECT_EQ(server.exit_code(), 0) << server.err();
    EXPECT_EQ(a.exit_code(), 0) << a.err();
  }
  int whole = 0;
  for (const auto& entry : std::filesystem::directory_iterator(runs_)) {
    whole += !entry.is_symlink() && std::filesystem::exists(ResultFolder(entry.path()).report());
  }
  EXPECT_EQ(whole, 2);
}

TEST_F(Fault, InterruptedRunWritesTheResult) {
  Program run("coslam", this->run());
  ASSERT_TRUE(run.says("agent cam1 joined")) << run.err();
  run.signal(SIGINT);
  EXPECT_EQ(run.exit_code(), 0) << run.err();
  EXPECT_TRUE(std::filesystem::exists(result_.report()));
}

TEST_F(Fault, KilledRunEndsItsProcesses) {
  Program run("coslam", this->run());
  ASSERT_TRUE(run.says("agent cam1 joined")) << run.err();
  run.signal(SIGKILL);
  EXPECT_EQ(run.exit_code(), 128 + SIGKILL);  // its children have ended too
  EXPECT_TRUE(std::filesystem::exists(result_.report())) << run.err();
}

TEST_F(Fault, LateAgentCatchesUp) {
  // The first comes to an image that is a pipe and waits there until the second has joined.
  constexpr int kGate = 40;
  const std::string gate = (scene_.folder() / "gate.png").string();
  ASSERT_EQ(mkfifo(gate.c_str(), 0600), 0);
  std::string list;
  for (int f = 0; f < kFrames; ++f) {
    list += std::to_string(f / SmallScene::kRate_hz) + "," + (f == kGate ? gate : scene_.image(0, f)) + "\n";
  }
  Program server("coslam-server", this->server());
  std::vector<std::string> gated = agent(0);
  std::ranges::replace(gated, scene_.source(0), scene_.folder().write("gated.csv", list).string());
  Program a("coslam-agent", gated);
  const int opened = open(gate.c_str(), O_WRONLY | O_CLOEXEC);  // waits for the reader
  ASSERT_GE(opened, 0);
  Program b("coslam-agent", agent(1));
  ASSERT_TRUE(server.says("agent cam1 joined")) << server.err();
  std::ifstream image(scene_.image(0, kGate), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(image), {}};
  EXPECT_EQ(write(opened, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  close(opened);
  ASSERT_TRUE(server.says("agent cam0 has ended")) << server.err();
  ASSERT_TRUE(server.says("agent cam1 has ended")) << server.err();
  server.signal(SIGINT);
  EXPECT_EQ(server.exit_code(), 0) << server.err();
  EXPECT_EQ(a.exit_code(), 0) << a.err();
  EXPECT_EQ(b.exit_code(), 0) << b.err();
  EXPECT_EQ(load_tum(latest().trajectory("cam0")).size(), static_cast<std::size_t>(kFrames));
  const Trajectory late = load_tum(latest().trajectory("cam1"));
  EXPECT_GT(late.size(), static_cast<std::size_t>(kFrames / 2)) << server.err();
  EXPECT_LT(late.size(), static_cast<std::size_t>(kFrames - kGate / 2));
  EXPECT_EQ(late.back().t_ns, load_tum(latest().trajectory("cam0")).back().t_ns);  // they end together
  Program eval("coslam", {"eval", runs_.string(), scene_.sequence()});
  ASSERT_EQ(eval.exit_code(), 0) << eval.err();
  // 0.015 to 0.029 over seven textures of the scene.
  EXPECT_LT(read_json(latest().evaluation())["ate_percent"].get<double>(), 0.085);
}

}  // namespace
}  // namespace coslam::fault_test
