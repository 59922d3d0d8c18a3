// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/program.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <stdexcept>

#include "common/base/error.h"
#include "common/base/version.h"
#include "tests/support/temp_folder.h"

namespace coslam::program_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

struct Ended {
  std::optional<int> code;  // empty: the program goes on
  std::string out, err;
};

template <class Action>
Ended ended(Action&& action) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Ended e;
  e.code = action();
  e.out = testing::internal::GetCapturedStdout();
  e.err = testing::internal::GetCapturedStderr();
  return e;
}

struct Settings {
  int tracks = 300;
  std::string name = "left";
};
template <class V>
void describe(V& v, Settings& s) {
  v.field("tracks", s.tracks, {20, 4000}, "features");
  v.field("name", s.name, "of the agent");
}

// A program "tool" with the command "map", which has "list" and "move FILE --speed".
class Program : public testing::Test {
 protected:
  Program() : app_("a tool", "/opt/bin/tool") {
    common_.add_to(app_, "tool.yaml", "tracks=100");
    app_.add_option("--rate", rate_);
    app_.require_subcommand(0, 1);
    CLI::App* map = app_.add_subcommand("map");
    map->require_subcommand(1);
    map->add_subcommand("list");
    CLI::App* move = map->add_subcommand("move");
    move->add_option("FILE", file_)->required();
    move->add_option("--speed", speed_);
  }

  Ended parse(std::vector<std::string> words) {
    words.insert(words.begin(), "/opt/bin/tool");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    return ended([&] { return parse_arguments(app_, static_cast<int>(argv.size()), argv.data()); });
  }
  std::string refusal(const std::vector<std::string>& words) {
    const Ended e = parse(words);
    EXPECT_EQ(e.code, 2) << e.err;
    EXPECT_EQ(e.out, "");
    EXPECT_EQ(std::ranges::count(e.err, '\n'), 1) << "one sentence: " << e.err;
    return e.err;
  }

  CommonArguments common_;
  double rate_ = 0, speed_ = 0;
  std::string file_;
  CLI::App app_;
};

TEST_F(Program, GoesOnWithGoodArguments) {
  const Ended e = parse({"--rate", "2.5", "--log-format", "json", "map", "move", "a.map", "--speed", "3"});
  EXPECT_FALSE(e.code) << e.err;
  EXPECT_EQ(rate_, 2.5);
  EXPECT_EQ(speed_, 3);
  EXPECT_EQ(file_, "a.map");
  EXPECT_EQ(common_.log_format, LogFormat::kJson);
}

TEST_F(Program, HelpAndVersionAreNoFailure) {
  const Ended help = parse({"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("--config"), HasSubstr("tracks=100"), HasSubstr("map")));
  const Ended version_told = parse({"--version"});
  EXPECT_EQ(version_told.code, 0);
  EXPECT_THAT(version_told.out, HasSubstr(version()));
}

TEST_F(Program, AMisspeltOptionIsToldWithTheNearest) {
  EXPECT_EQ(refusal({"--rat", "3"}), "tool: there is no option '--rat', did you mean '--rate'? (see tool --help)\n");
  EXPECT_THAT(refusal({"map", "move", "a.map", "--sped", "3"}),
              StartsWith("tool map move: there is no option '--sped', did you mean '--speed'?"));
  EXPECT_THAT(refusal({"--quite-another"}), AllOf(HasSubstr("'--quite-another'"), Not(HasSubstr("did you mean"))));
}

TEST_F(Program, AMisspeltCommandIsToldWithTheNearest) {
  EXPECT_EQ(refusal({"mab"}), "tool: there is no command 'mab', did you mean 'map'? (see tool --help)\n");
  EXPECT_EQ(refusal({"map", "lis"}),
            "tool map: there is no command 'lis', did you mean 'list'? (see tool map --help)\n");
}

TEST_F(Program, AMissingCommandIsToldWithAllThereAre) {
  EXPECT_THAT(refusal({"map"}),
              AllOf(StartsWith("tool map: "), HasSubstr(": one of list, move (see tool map --help)")));
}

TEST_F(Program, WhatIsMissingOrWrongIsNamed) {
  EXPECT_THAT(refusal({"map", "move"}), AllOf(StartsWith("tool map move: "), HasSubstr("FILE")));
  EXPECT_THAT(refusal({"--rate", "fast"}), HasSubstr("--rate"));
  EXPECT_THAT(refusal({"--rate"}), HasSubstr("--rate"));
  EXPECT_THAT(refusal({"--log-format", "xml"}), HasSubstr("'xml' is neither text nor json"));
  EXPECT_THAT(refusal({"map", "list", "more"}), HasSubstr("more"));
}

TEST_F(Program, AKeyOnTheCommandLineGoesBeforeThatOfTheFile) {
  const test::TempFolder folder;
  const std::string file = folder.write("tool.yaml", "tracks: 50\nname: right\n").string();
  EXPECT_FALSE(parse({"--config", file, "--set", "tracks=60", "--set", "tracks=70"}).code);
  Settings settings;
  common_.apply_to(settings);
  EXPECT_EQ(settings.tracks, 70);
  EXPECT_EQ(settings.name, "right");
  Settings defaults;
  CommonArguments().apply_to(defaults);
  EXPECT_EQ(defaults.tracks, 300);
}

TEST_F(Program, ThePrintedConfigurationReadsBack) {
  const Ended e = ended([] {
    print_config("tool", Settings{.tracks = 77, .name = "right"});
    return 0;
  });
  EXPECT_THAT(e.out, StartsWith("# All keys of tool; "));
  const test::TempFolder folder;
  Settings settings;
  config::load(settings, folder.write("tool.yaml", e.out));
  EXPECT_EQ(settings.tracks, 77);
  EXPECT_EQ(settings.name, "right");
}

TEST(RunProgram, AnExceptionIsASentenceAndAnExitCode) {
  const auto run = [](const std::function<int()>& body) { return ended([&] { return run_program("tool", body); }); };
  EXPECT_EQ(run([] { return 7; }).code, 7);
  EXPECT_EQ(run([] { return 7; }).err, "");
  const Ended wrong = run([]() -> int { throw UsageError("two of them"); });
  EXPECT_EQ(wrong.code, 2);
  EXPECT_EQ(wrong.err, "tool: two of them\n");
  const Ended failed = run([]() -> int { throw UserError("a.yaml: is not there"); });
  EXPECT_EQ(failed.code, 1);
  EXPECT_EQ(failed.err, "tool: a.yaml: is not there\n");
  EXPECT_EQ(run([]() -> int { throw std::runtime_error("bug"); }).code, 1);
  const Ended files = run([] { return static_cast<int>(std::filesystem::file_size("/nowhere/file")); });
  EXPECT_EQ(files.code, 1);
  EXPECT_EQ(files.err, "tool: /nowhere/file: No such file or directory\n");
}

}  // namespace
}  // namespace coslam::program_test
