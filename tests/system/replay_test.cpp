// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// `coslam run --record` and `coslam replay` as a user meets them.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "common/dataset/result.h"
#include "tests/support/result_files.h"
#include "tests/support/test_domain.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam::replay_test {
namespace {

using test::expect_same_result;
using test::Program;
using test::SmallScene;
using ::testing::HasSubstr;
using ::testing::Not;

class Replay : public ::testing::Test {
 protected:
  // How `coslam` with these words and a result folder ends.
  int run(std::vector<std::string> words, const std::string& out) {
    words.insert(words.end(), {"--out", folder(out).string()});
    Program program("coslam", words);
    const int code = program.exit_code();
    text_ = program.out() + program.err();
    return code;
  }
  int record(const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> words{"run", scene_.sequence(), "--record", recording_};
    words.insert(words.end(), more.begin(), more.end());
    return run(words, out);
  }
  std::filesystem::path folder(const std::string& name) const { return scene_.folder() / name; }
  nlohmann::json configured(const std::string& out) const {
    return read_json(ResultFolder(folder(out)).report())["configuration"];
  }

  SmallScene scene_;
  const std::string recording_ = folder("a.rec").string();
  std::string text_;
};

TEST_F(Replay, OfARunInOneProcessIsThatRun) {
  ASSERT_EQ(record("run", {"--inline"}), 0) << text_;
  EXPECT_THAT(text_, Not(HasSubstr("recording"))) << "nothing to say of it";
  ASSERT_EQ(run({"replay", recording_}, "first"), 0) << text_;
  EXPECT_THAT(text_, HasSubstr("result: " + folder("first").string()));
  expect_same_result(folder("run"), folder("first"));
  ASSERT_EQ(run({"replay", recording_}, "second"), 0) << text_;
  expect_same_result(folder("run"), folder("second"));
  EXPECT_EQ(run({"replay", recording_}, "second"), 1) << "a folder holds one run";
  EXPECT_THAT(text_, HasSubstr("holds a run already"));
  EXPECT_EQ(run({"replay", recording_, "--force", "--rate", "10"}, "second"), 0) << text_;
}

TEST_F(Replay, OfProcessesIsThatRun) {
  const test::TestDomain domain;
  ASSERT_EQ(record("run", {"--domain", std::to_string(domain.number())}), 0) << text_;
  ASSERT_EQ(run({"replay", recording_}, "replay"), 0) << text_;
  expect_same_result(folder("run"), folder("replay"));
  nlohmann::json server = configured("run")["server"];
  server.erase("view");  // which a replay does not have
  EXPECT_EQ(server, configured("replay")["server"]);
}

TEST_F(Replay, TakesOtherSettings) {
  ASSERT_EQ(record("run", {"--inline", "--set", "server.theta=2.5"}), 0) << text_;
  ASSERT_EQ(run({"replay", recording_, "--set", "server.events.enabled=false"}, "replay"), 0) << text_;
  EXPECT_EQ(configured("replay")["server"]["theta"], 2.5);
  EXPECT_FALSE(std::filesystem::exists(folder("replay/events.csv")));
  EXPECT_EQ(run({"replay", recording_, "--set", "server.no_such_key=1"}, "none"), 2);
  EXPECT_FALSE(std::filesystem::exists(folder("none")));
}

TEST_F(Replay, OfABrokenRecording) {
  ASSERT_EQ(record("run", {"--inline", "--agents", "cam0"}), 0) << text_;
  const auto size = std::filesystem::file_size(recording_);
  std::filesystem::resize_file(recording_, 2 * size / 3);
  EXPECT_EQ(run({"replay", recording_}, "cut"), 1) << "what is left is too little for a map: " << text_;
  EXPECT_THAT(text_, HasSubstr("nothing was mapped"));
  EXPECT_THAT(text_, HasSubstr("a.rec was cut off"));
  std::fstream file(recording_, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::streamoff>(size / 2));
  file.put('!');
  file.put('?');
  file.close();
  EXPECT_EQ(run({"replay", recording_}, "damaged"), 1);
  EXPECT_THAT(text_, HasSubstr("a.rec: record "));
  EXPECT_THAT(text_, HasSubstr(" is damaged\n"));
  EXPECT_FALSE(std::filesystem::exists(folder("damaged")));
}

}  // namespace
}  // namespace coslam::replay_test
