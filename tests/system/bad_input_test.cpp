// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What a user may get wrong: one sentence that names it, and the exit code of docs/configuration.md.
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "common/dataset/calibration.h"
#include "common/dataset/result.h"
#include "tests/support/all_ports.h"
#include "tests/support/test_domain.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam::bad_input_test {
namespace {

using test::lines_with;
using test::Program;
using test::SmallScene;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr int kFailed = 1, kWrongUsage = 2;

// The program ends with this code, and its standard error is one line that holds all these parts.
void expect_sentence(Program& program, int code, const std::vector<std::string>& parts) {
  EXPECT_EQ(program.exit_code(), code) << program.err();
  EXPECT_EQ(std::count(program.err().begin(), program.err().end(), '\n'), 1) << program.err();
  for (const std::string& part : parts) EXPECT_THAT(program.err(), HasSubstr(part));
}

class BadInput : public ::testing::Test {
 protected:
  std::vector<std::string> run(const std::string& sequence, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"run", sequence, "--out", result_.path().string(), "--domain", domain()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  std::vector<std::string> agent(const std::string& source, const std::string& rate = "max") const {
    return {"--loopback",    "--domain",           domain(), "--id", "cam0", "--source", source,
            "--calibration", scene_.calibration(), "--rate", rate};
  }
  std::vector<std::string> server() const { return {"--loopback", "--domain", domain()}; }
  std::string sequence(const std::string& source, const std::string& calibration) const {
    return scene_.folder()
        .write("bad.yaml", "name: bad\nrate_hz: 30\nagents:\n  - {name: cam0, source: " + source +
                               ", calibration: " + calibration + "}\n")
        .string();
  }
  std::string file(const std::string& name) const { return (scene_.folder() / name).string(); }
  std::string domain() const { return std::to_string(domain_.number()); }

  const SmallScene scene_{2, 20};
  const ResultFolder result_{scene_.folder() / "result"};
  const test::TestDomain domain_;
};

TEST_F(BadInput, MissingSequence) {
  Program run("coslam", this->run(file("nowhere.yaml")));
  expect_sentence(run, kFailed, {"coslam: " + file("nowhere.yaml") + ": there is no such sequence"});
}

TEST_F(BadInput, MissingSource) {
  Program run("coslam", this->run(sequence("nowhere", "calibration.yaml")));
  expect_sentence(run, kFailed, {"bad.yaml:4: agents[0].source: there is no " + file("nowhere")});
  Program agent("coslam-agent", this->agent(file("nowhere")));
  expect_sentence(agent, kFailed, {"coslam-agent: ", file("nowhere")});
  Program camera("coslam-agent", this->agent("v4l2:99"));
  expect_sentence(camera, kFailed, {"coslam-agent: ", "v4l2:99"});
}

TEST_F(BadInput, TheDomainOfTheFleetForNodes) {
  Program agent("coslam-agent", this->agent("ros2:/image?domain=" + domain()));
  expect_sentence(agent, kFailed, {"DDS domain " + domain() + " is that of the fleet and of ros2:/image"});
}

TEST_F(BadInput, ATrackingDeviceThatIsNotThere) {
  const std::string no_drivers = scene_.folder().path().string();
  ::setenv("OCL_ICD_VENDORS", no_drivers.c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  Program run("coslam", this->run(scene_.sequence(), {"--set", "agent.tracker.device=opencl"}));
  expect_sentence(run, kFailed, {"agent.tracker.device", "opencl"});
  ::unsetenv("OCL_ICD_VENDORS");  // NOLINT(concurrency-mt-unsafe)
}

TEST_F(BadInput, CalibrationOfAnotherSize) {
  save_calibration(scene_.folder() / "vga.yaml", {640, 480, 500, 500, 320, 240, DistortionModel::kNone, {}});
  Program run("coslam", this->run(sequence("cam0.csv", "vga.yaml")));
  expect_sentence(run, kFailed, {scene_.image(0, 0), "320x240", file("vga.yaml"), "640x480"});
}

TEST_F(BadInput, NoImageReadable) {
  scene_.folder().write("bad.csv", "0,calibration.yaml\n1,nowhere.png\n");
  Program run("coslam", this->run(sequence("bad.csv", "calibration.yaml")));
  expect_sentence(run, kFailed, {"bad.csv: none of the 2 images can be read", file("calibration.yaml")});
}

TEST_F(BadInput, BrokenImagesAreNamedAndPassedOver) {
  std::filesystem::resize_file(scene_.image(1, 7), std::filesystem::file_size(scene_.image(1, 7)) / 2);
  std::filesystem::remove(scene_.image(1, 9));
  Program run("coslam", this->run(scene_.sequence()));
  EXPECT_EQ(run.exit_code(), 0) << run.err();
  EXPECT_THAT(lines_with(run.err(), "cannot be read"), SizeIs(1)) << run.err();  // one a second at most
  EXPECT_THAT(run.err(), HasSubstr(scene_.image(1, 7) + " cannot be read"));
  const auto report = read_json(result_.report());
  EXPECT_EQ(report["agents"]["cam0"]["left_out"], nlohmann::json::object());
  EXPECT_EQ(report["agents"]["cam1"]["left_out"]["unreadable"], 2);
  EXPECT_EQ(report["agents"]["cam1"]["frames"], 20);
  EXPECT_EQ(report["agents"]["cam1"]["images"]["left_out"], 2);
}

TEST_F(BadInput, UnknownKey) {
  Program run("coslam", this->run(scene_.sequence(), {"--set", "agent.tracker.max_track=9"}));
  expect_sentence(run, kWrongUsage, {"agent.tracker.max_track", "did you mean 'agent.tracker.max_tracks'?"});
  const std::string config = scene_.folder().write("server.yaml", "server:\n  thetta: 3\n").string();
  Program server("coslam-server", {"--config", config});
  expect_sentence(server, kFailed, {config + ":2: server.thetta", "did you mean 'theta'?"});
  Program agent("coslam-agent", {"--config", file("nowhere.yaml")});
  expect_sentence(agent, kFailed, {file("nowhere.yaml")});
}

TEST_F(BadInput, WrongUsage) {
  Program agent("coslam-agent", {"--calibration", scene_.calibration()});
  expect_sentence(agent, kWrongUsage, {"--source is missing"});
  Program run("coslam", this->run(scene_.sequence(), {"--agents", "cam9"}));
  expect_sentence(run, kWrongUsage, {"has no agent 'cam9', its agents are cam0"});
  Program twice("coslam-server", {"--set", "agents=a,a"});
  expect_sentence(twice, kFailed, {"agents: 'a' is named twice"});
  Program covered("coslam-agent", {"--source", scene_.source(0), "--covered", "3", "1"});
  expect_sentence(covered, kWrongUsage, {"--covered: the second time must be later than the first"});
  Program domain("coslam-server", {"--domain", "233"});
  EXPECT_EQ(domain.exit_code(), kWrongUsage);
  EXPECT_THAT(domain.err(), AllOf(HasSubstr("--domain: Value 233 not in range"), HasSubstr("232")));
}

TEST_F(BadInput, DomainOfAnotherServer) {
  Program first("coslam-server", this->server());
  Program agent("coslam-agent", this->agent(scene_.source(0)));
  ASSERT_TRUE(first.says("agent cam0 joined")) << first.err();
  Program second("coslam-server", this->server());
  expect_sentence(second, kFailed, {"another map server is at work in DDS domain " + domain()});
  Program run("coslam", this->run(scene_.sequence()));
  expect_sentence(run, kFailed, {"another map server is at work in DDS domain " + domain()});
  first.signal(SIGINT);
  EXPECT_EQ(first.exit_code(), 0);
  EXPECT_THAT(lines_with(first.err(), " joined"), SizeIs(1)) << "it met nobody else: " << first.err();
}

TEST_F(BadInput, ARefusedServerTouchesNoResult) {
  std::vector<std::string> words = server();
  words.insert(words.end(), {"--out", file("runs")});
  Program first("coslam-server", words);
  Program agent("coslam-agent", this->agent(scene_.source(0)));
  ASSERT_TRUE(agent.says("info: playing ")) << agent.err() << first.err();
  Program second("coslam-server", words);
  EXPECT_EQ(second.exit_code(), kFailed) << second.err();
  first.signal(SIGINT);
  EXPECT_EQ(first.exit_code(), 0) << first.err();
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file("runs")), {}), 2) << "one run and the link";
  EXPECT_TRUE(std::filesystem::exists(find_result(file("runs")).report()));
}

TEST_F(BadInput, DomainWithoutFreePort) {
  const test::AllPorts taken(domain_.number());
  const std::string sentence = "no UDP port is free for DDS domain " + domain();
  Program run("coslam", this->run(scene_.sequence()));
  expect_sentence(run, kFailed, {sentence});
  Program agent("coslam-agent", this->agent(scene_.source(0)));
  expect_sentence(agent, kFailed, {sentence});
}

TEST_F(BadInput, SameNameTwice) {
  Program server("coslam-server", this->server());
  // It plays in real time and waits for its second image.
  scene_.folder().write("long.csv", "0," + scene_.image(0, 0) + "\n10000," + scene_.image(0, 1) + "\n");
  Program first("coslam-agent", agent(file("long.csv"), "1"));
  ASSERT_TRUE(server.says("agent cam0 joined")) << server.err() << first.err();
  Program second("coslam-agent", agent(scene_.source(0)));
  EXPECT_EQ(second.exit_code(), kFailed) << second.err();
  EXPECT_THAT(second.err(), ::testing::EndsWith("coslam-agent: the name 'cam0' is taken by a running agent\n"));
  first.signal(SIGINT);
  EXPECT_EQ(first.exit_code(), 0) << first.err();
}

TEST_F(BadInput, ResultFolderThatCannotBeMade) {
  scene_.folder().write("file", "");
  Program run("coslam", {"run", scene_.sequence(), "--out", file("file/result")});
  expect_sentence(run, kFailed, {"cannot make the result folder " + file("file/result")});
  Program server("coslam-server", {"--loopback", "--domain", domain(), "--out", file("file/result")});
  expect_sentence(server, kFailed, {"cannot make the result folder " + file("file/result")});
}

}  // namespace
}  // namespace coslam::bad_input_test
