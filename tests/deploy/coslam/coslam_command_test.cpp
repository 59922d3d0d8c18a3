// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The program `coslam` as a user meets it: exit codes and sentences.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>

#include "common/dataset/calibration.h"
#include "common/dataset/result.h"
#include "common/dataset/trajectory.h"
#include "tests/support/temp_folder.h"

namespace coslam::coslam_command_test {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct Outcome {
  int exit_code = -1;
  std::string text;  // stdout and stderr
};

Outcome coslam(const std::string& arguments) {
  Outcome outcome;
  FILE* pipe = popen((std::string(COSLAM_PROGRAM) + " " + arguments + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> part{};
  while (fgets(part.data(), part.size(), pipe) != nullptr) outcome.text += part.data();
  const int status = pclose(pipe);
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  return outcome;
}

class CoslamCommand : public ::testing::Test {
 protected:
  CoslamCommand() {
    save_calibration(temp_ / "calib.yaml", {640, 480, 400, 400, 320, 240, DistortionModel::kNone, {}});
    temp_.write("list.csv", "t_s,file\n0,a.png\n");
    sequence_ = temp_
                    .write("sequence.yaml",
                           "name: line\nrate_hz: 10\nagents:\n"
                           "  - {name: cam0, source: list.csv, calibration: calib.yaml, truth: truth.tum}\n")
                    .string();
    Trajectory trajectory;
    for (int i = 0; i < 20; ++i) {
      trajectory.push_back({i * 100'000'000LL, Rigid3({1, 0, 0, 0}, {0.1 * i, 0.01 * i * i, 0}).inverse()});
    }
    save_tum(temp_ / "truth.tum", trajectory);
    save_tum(result_.trajectory("cam0"), trajectory);
  }
  std::string result() const { return result_.path().string(); }

  test::TempFolder temp_;
  ResultFolder result_{temp_ / "result"};
  std::string sequence_;
};

TEST_F(CoslamCommand, AWrongRateIsSaidBeforeAnythingStarts) {
  for (const char* rate : {"fast", "0", "-1", "2x", "nan"}) {
    const Outcome o = coslam("run " + sequence_ + " --rate " + rate + " --out " + (temp_ / "out").string());
    EXPECT_EQ(o.exit_code, 2) << rate;
    EXPECT_THAT(o.text, HasSubstr("--rate takes a positive number or max, not '" + std::string(rate) + "'"));
    EXPECT_FALSE(std::filesystem::exists(temp_ / "out")) << rate;
  }
}

TEST_F(CoslamCommand, Usage) {
  EXPECT_EQ(coslam("--help").exit_code, 0);
  for (const char* command :
       {"run", "replay", "eval", "explain", "render", "export", "status", "calibrate", "calibration"}) {
    const Outcome help = coslam(std::string(command) + " --help");
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_THAT(help.text, HasSubstr("Usage: coslam " + std::string(command)));
  }
  EXPECT_EQ(coslam("").exit_code, 2);
  EXPECT_EQ(coslam("fly").exit_code, 2);
  EXPECT_EQ(coslam("eval").exit_code, 2);
  EXPECT_EQ(coslam("render room x --frames -1").exit_code, 2);
}

TEST_F(CoslamCommand, AWordThatIsUnknownIsNamedWithItsNeighbour) {
  const auto says = [](const std::string& arguments) {
    const Outcome o = coslam(arguments);
    EXPECT_EQ(o.exit_code, 2) << arguments;
    return o.text;
  };
  EXPECT_EQ(says("rum x"), "coslam: there is no command 'rum', did you mean 'run'? (see coslam --help)\n");
  EXPECT_THAT(says("map chek x"), HasSubstr("coslam map: there is no command 'chek', did you mean 'check'?"));
  EXPECT_THAT(says("map"), HasSubstr("one of list, check"));
  EXPECT_THAT(says("run x --oot y"), HasSubstr("coslam run: there is no option '--oot', did you mean '--out'?"));
  EXPECT_THAT(says("export a b --fromat ply"), HasSubstr("did you mean '--format'?"));
  EXPECT_THAT(says("export a b"), HasSubstr("coslam export: --format is required (see coslam export --help)"));
  EXPECT_THAT(says("render room x --frames -1"),
              AnyOf(HasSubstr("in range 1 to 1000000"), HasSubstr("in range [1 - 1000000]")));
  EXPECT_EQ(says("render room x --seed -1").find("e+"), std::string::npos);
}

TEST_F(CoslamCommand, AgentsThatAreNotThereOrNamedTwice) {
  const std::string run = "run " + sequence_ + " --out " + (temp_ / "out").string() + " --agents ";
  EXPECT_THAT(coslam(run + "cam7").text, HasSubstr("has no agent 'cam7', its agents are cam0"));
  const Outcome twice = coslam(run + "cam0,cam0");
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.text, HasSubstr("--agents names cam0 twice"));
}

TEST_F(CoslamCommand, AResultNeverReplacesWhatIsPlayed) {
  for (const char* force : {"", " --force"}) {
    const Outcome own = coslam("run " + sequence_ + " --out " + temp_.path().string() + force);
    EXPECT_EQ(own.exit_code, 1);
    EXPECT_THAT(own.text, HasSubstr("is to be played, and lies where the result"));
    EXPECT_TRUE(std::filesystem::exists(sequence_));
  }
}

TEST_F(CoslamCommand, APortOfViewTakesAnEqualsSign) {
  const Outcome loose = coslam("run " + sequence_ + " --view 8766");
  EXPECT_EQ(loose.exit_code, 2);
  EXPECT_THAT(loose.text, HasSubstr("--view=8766"));
  EXPECT_THAT(coslam("run " + sequence_ + " --view=99999").text, HasSubstr("--view: Value 99999 not in range"));
}

TEST_F(CoslamCommand, ACalibrationIsNotReplacedByItsTranslation) {
  const std::string file = (temp_ / "calib.yaml").string();
  const auto before = std::filesystem::file_size(file);
  EXPECT_EQ(coslam("calibration " + file + " --to ros --out " + file).exit_code, 2);
  EXPECT_EQ(std::filesystem::file_size(file), before);
  EXPECT_THAT(coslam("calibration " + file + " --draw " + (temp_ / "a.xyz").string()).text, HasSubstr(".png"));
  EXPECT_EQ(coslam("calibration " + file + " --draw " + (temp_ / "new/a.png").string()).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(temp_ / "new/a.png"));
}

TEST_F(CoslamCommand, StandardOutputThatIsFullIsAFailure) {
  EXPECT_EQ(coslam("calibration " + (temp_ / "calib.yaml").string() + " > /dev/full").exit_code, 1);
}

TEST_F(CoslamCommand, Explain) {
  const std::string file = "result/events.csv", columns = "t_s,set,kind,why,map,from,point,other,camera,track,to,a,b\n";
  const std::string event = "0.5,9,point_made,two_cameras_now,1,,3,,,,static,,0.01\n";
  EXPECT_EQ(coslam("explain " + result() + " point 3").exit_code, 1) << "no events.csv";
  temp_.write(file, columns + event + "3.0,90,end,run_is_over,,,,,,,,,\n");
  const Outcome life = coslam("explain " + result() + " point 3");
  EXPECT_EQ(life.exit_code, 0) << life.text;
  EXPECT_THAT(life.text, HasSubstr("0.500 s  It was made, static, from two cameras at once"));
  EXPECT_THAT(coslam("explain " + result() + " point 3 --at 2").text, HasSubstr("At 2.000 s point 3 was static"));
  const Outcome unknown = coslam("explain " + result() + " point 4");
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.text, HasSubstr("does not speak of point 4"));
  temp_.write(file, columns + event);
  const Outcome cut = coslam("explain " + result() + " point 3");
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_THAT(cut.text, HasSubstr("It was made"));
  EXPECT_THAT(cut.text, HasSubstr("events.csv has no end"));
  for (const char* wrong :
       {"", " point", " wall 3", " point three", " track 3", " point 3 --at soon", " point 3 --at -1"})
    EXPECT_EQ(coslam("explain " + result() + wrong).exit_code, 2) << wrong;
}

TEST_F(CoslamCommand, Eval) {
  write_json(result_.report(), {{"agents", {{"cam0", {{"frames", 20}}}}}});
  const Outcome outcome = coslam("eval " + result() + " " + sequence_);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("joint ATE 0.0000 m"));
  EXPECT_TRUE(std::filesystem::exists(result_.top_view()));
  EXPECT_LT(read_json(result_.evaluation())["ate_m"].get<double>(), 1e-6);
  const Outcome json = coslam("eval --json " + result() + " " + sequence_);
  EXPECT_EQ(nlohmann::json::parse(json.text)["sequence"], "line");
}

TEST_F(CoslamCommand, TheLatestRunOfAServerIsAResult) {
  std::filesystem::create_directory(temp_ / "runs");
  std::filesystem::rename(result_.path(), temp_ / "runs/20261123T084512Z-01");
  std::filesystem::create_symlink("20261123T084512Z-01", temp_ / "runs/latest");
  const ResultFolder run(temp_ / "runs/20261123T084512Z-01");
  write_json(run.report(),
             {{"agents", {{"cam0", {{"frames", 20}}}}}, {"maps", {{{"map", 1}, {"agents", {{"cam0", 20}}}}}}});
  const std::string runs = (temp_ / "runs").string();
  const Outcome eval = coslam("eval " + runs + " " + sequence_);
  EXPECT_EQ(eval.exit_code, 0) << eval.text;
  EXPECT_THAT(eval.text, Not(HasSubstr("warning")));
  EXPECT_TRUE(std::filesystem::exists(run.evaluation()));
  EXPECT_EQ(coslam("export " + runs + " --format tum " + (temp_ / "out").string()).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(temp_ / "out/cam0.tum"));
  temp_.write("runs/latest/events.csv",
              "t_s,set,kind,why,map,from,point,other,camera,track,to,a,b\n"
              "0.5,9,point_made,two_cameras_now,1,,3,,,,static,,0.01\n3.0,90,end,run_is_over,,,,,,,,,\n");
  EXPECT_EQ(coslam("explain " + runs + " point 3").exit_code, 0);
}

TEST_F(CoslamCommand, AResultWithoutReportIsReadWithOneWarning) {
  for (const std::string& command :
       {"eval " + result() + " " + sequence_, "export " + result() + " --format tum " + (temp_ / "out").string()}) {
    const Outcome outcome = coslam(command);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    const std::size_t warning = outcome.text.find("coslam: warning: " + result() + " has no report.json");
    EXPECT_NE(warning, std::string::npos) << outcome.text;
    EXPECT_EQ(outcome.text.find("warning", warning + 20), std::string::npos) << "once";
  }
}

TEST_F(CoslamCommand, FailuresAreOneSentence) {
  const Outcome no_result = coslam("eval /nowhere " + sequence_);
  EXPECT_EQ(no_result.exit_code, 1);
  EXPECT_EQ(no_result.text, "coslam: /nowhere: there is no such result folder\n");
  EXPECT_EQ(coslam("eval " + result() + " /nowhere").exit_code, 1);
  const Outcome scene = coslam("render no-such-scene " + result());
  EXPECT_EQ(scene.exit_code, 1);
  EXPECT_THAT(scene.text, HasSubstr("no-such-scene"));
}

TEST_F(CoslamCommand, NoAgentPlaysTwice) {
  const Outcome o = coslam("run " + sequence_ + " --agents cam0,cam0 --out " + (temp_ / "out").string());
  EXPECT_EQ(o.exit_code, 2);
  EXPECT_EQ(o.text, "coslam: --agents names cam0 twice\n");
}

TEST_F(CoslamCommand, ReplayOfWhatIsNoRecording) {
  const std::string out = " --out " + (temp_ / "out").string();
  const std::string text = temp_.write("a.txt", "no recording of anybody").string();
  const Outcome no_recording = coslam("replay " + text + out);
  EXPECT_EQ(no_recording.exit_code, 1);
  EXPECT_EQ(no_recording.text, "coslam: " + text + " is no recording of coslam\n");
  const Outcome nothing = coslam("replay /nowhere" + out);
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_EQ(nothing.text, "coslam: /nowhere: cannot be read: there is no such file\n");
  EXPECT_EQ(coslam("replay " + text + " --rate fast" + out).exit_code, 2);
  EXPECT_EQ(coslam("replay").exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(temp_ / "out"));
}

TEST_F(CoslamCommand, ARecordingIsNeverOverwritten) {
  const std::string file = temp_.write("a.rec", "precious").string();
  for (const char* how : {"", " --inline"}) {
    const Outcome o = coslam("run " + sequence_ + " --record " + file + how + " --out " + (temp_ / "out").string());
    EXPECT_EQ(o.exit_code, 1);
    EXPECT_EQ(o.text, "coslam: " + file + " exists already: name another file for the recording\n");
  }
  EXPECT_EQ(std::filesystem::file_size(file), 8U);
  EXPECT_FALSE(std::filesystem::exists(temp_ / "out"));
}

TEST_F(CoslamCommand, Export) {
  const std::string out = (temp_ / "out").string();
  EXPECT_EQ(coslam("export " + result() + " --format kitti " + out).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(temp_ / "out/cam0.txt"));
  EXPECT_THAT(coslam("export --help").text, Not(HasSubstr("rosbag2")));
  EXPECT_EQ(coslam("export " + result() + " --format colmap " + out).exit_code, 2);  // needs --sequence
  EXPECT_EQ(coslam("export " + result() + " --format ply --undistort " + out).exit_code, 2);
  EXPECT_EQ(coslam("export " + result() + " --format rosbag2 " + out).exit_code, 2);
  EXPECT_EQ(coslam("export " + result() + " --format dwg " + out).exit_code, 2);
  EXPECT_EQ(coslam("export " + result() + " --format tum --sequence " + sequence_ + " " + out).exit_code, 2);
  EXPECT_THAT(coslam("export " + result() + " --format tum " + result()).text, HasSubstr("is the result itself"));
}

}  // namespace
}  // namespace coslam::coslam_command_test
