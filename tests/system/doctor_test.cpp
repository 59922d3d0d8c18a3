// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// `coslam doctor` beside running programs.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "tests/support/test_domain.h"
#include "tests/system/program.h"
#include "tests/system/small_scene.h"

namespace coslam::doctor_test {
namespace {

using nlohmann::json;
using test::Program;
using test::SmallScene;
using ::testing::HasSubstr;

class Doctor : public ::testing::Test {
 protected:
  std::string number() const { return std::to_string(domain_.number()); }
  std::vector<std::string> words(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"doctor", "--loopback", "--domain", number(), "--json"});
    return more;
  }
  std::string key(const std::string& name, const std::string& secret) const {
    const std::string file = scene_.folder().write(name, secret).string();
    chmod(file.c_str(), 0600);
    return file;
  }

  const SmallScene scene_{1, 900};  // half a minute in real time
  const test::TestDomain domain_;
};

// The first finding about this.
json about(const json& report, const std::string& subject) {
  for (const json& finding : report["findings"]) {
    if (finding["subject"] == subject) return finding;
  }
  return {{"grade", "nothing was found about " + subject}, {"found", ""}, {"mend", ""}};
}

TEST_F(Doctor, HearsAFleetAndIsHeard) {
  Program server("coslam-server", {"--loopback", "--domain", number()});
  ASSERT_TRUE(server.says("an agent joins with: coslam-agent --loopback --domain " + number())) << server.err();
  Program agent("coslam-agent", scene_.agent(0, number(), "1"));
  ASSERT_TRUE(server.says("agent cam0 joined")) << server.err();
  Program doctor("coslam", words({"--source", scene_.source(0), "--calibration", scene_.calibration(), "--out",
                                  scene_.folder().path().string()}));
  doctor.exit_code();
  const json report = json::parse(doctor.out(), nullptr, false);
  ASSERT_TRUE(report.is_object()) << doctor.out() << doctor.err();
  for (const char* who : {"map server", "agent cam0"}) {
    const json found = about(report, who);
    EXPECT_NE(found["grade"], "FAIL") << found;
    EXPECT_THAT(found["found"], HasSubstr("127.0.0.1, protocol")) << found;
    EXPECT_THAT(found["found"], HasSubstr("ms there and back")) << found;
  }
  EXPECT_EQ(about(report, "ports")["grade"], "ok") << doctor.out();
  EXPECT_THAT(about(report, "images")["found"], HasSubstr("320x240 at 30 Hz")) << doctor.out();
  EXPECT_EQ(about(report, "picture")["grade"], "ok") << doctor.out();
  EXPECT_THAT(about(report, "tracking")["found"], HasSubstr("tracks")) << doctor.out();
  for (Program* program : {&agent, &server}) {
    program->signal(SIGINT);
    EXPECT_EQ(program->exit_code(), 0) << program->err();
  }
}

TEST_F(Doctor, NobodyThere) {
  Program doctor("coslam", words());
  EXPECT_EQ(doctor.exit_code(), 1) << doctor.out();
  const json found = about(json::parse(doctor.out()), "peer 127.0.0.1");
  EXPECT_EQ(found["grade"], "FAIL") << doctor.out();
  EXPECT_THAT(found["found"], HasSubstr("nothing runs in domain " + number() + " at 127.0.0.1"));
  EXPECT_THAT(found["mend"], HasSubstr("coslam-server"));
}

TEST_F(Doctor, AnotherKey) {
  const std::string right = key("right.key", "the secret of this fleet"),
                    wrong = key("wrong.key", "the secret of another");
  Program server("coslam-server", {"--loopback", "--domain", number(), "--set", "wire.key_file=" + right});
  ASSERT_TRUE(server.says("with the fleet's key")) << server.err();
  Program with_it("coslam", words({"--key", right}));
  with_it.exit_code();
  EXPECT_THAT(about(json::parse(with_it.out()), "map server")["found"], HasSubstr("with the key")) << with_it.out();
  Program with_another("coslam", words({"--key", wrong}));
  EXPECT_EQ(with_another.exit_code(), 1);
  EXPECT_THAT(about(json::parse(with_another.out()), "key")["found"], HasSubstr("with another key than " + wrong))
      << with_another.out();
  Program without("coslam", words());
  EXPECT_EQ(without.exit_code(), 1);
  EXPECT_THAT(about(json::parse(without.out()), "key")["found"], HasSubstr("this machine has no key")) << without.out();
}

}  // namespace
}  // namespace coslam::doctor_test
