// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/files.h"

#include <sys/stat.h>

#include "tests/deploy/coslam/doctor/said.h"
#include "tests/support/temp_folder.h"

namespace coslam::doctor::files_test {
namespace {

class DoctorFiles : public ::testing::Test {
 protected:
  Finding key(const std::string& file) const {
    WireConfig wire;
    wire.key_file = file;
    return first_of(judge(look_at_key(wire)));
  }
  std::string with_rights(const std::string& name, const std::string& content, mode_t rights) const {
    const std::string file = folder_.write(name, content).string();
    chmod(file.c_str(), rights);
    return file;
  }

  const test::TempFolder folder_;
};

TEST_F(DoctorFiles, Keys) {
  const std::string secret = "the secret of this fleet";
  EXPECT_THAT(key(""), Says(Grade::kOk, "none", ""));
  EXPECT_THAT(key(with_rights("good", secret, 0600)), Says(Grade::kOk, "fit", ""));
  const std::string open = with_rights("open", secret, 0644), brief = with_rights("brief", "abc", 0600);
  EXPECT_THAT(key(open), Says(Grade::kFail, "is open to others", "chmod 600 " + open));
  EXPECT_THAT(key(brief), Says(Grade::kFail, "less than 16 bytes", "head -c 32"));
  EXPECT_THAT(key((folder_ / "none").string()), Says(Grade::kFail, "No such file", "scp"));
}

TEST_F(DoctorFiles, ConfigOfAnAgentAndOfTheServer) {
  AgentOptions settings;
  const std::string agent = folder_.write("agent.yaml", "id: left\nsource: v4l2:0\nwire: {domain: 7}\n").string();
  EXPECT_THAT(first_of(read_config(agent, settings)), Says(Grade::kOk, "known to agents", ""));
  EXPECT_EQ(settings.source, "v4l2:0");
  EXPECT_EQ(settings.wire.domain, 7);
  const std::string server =
      folder_.write("server.yaml", "agents: [left]\nwire: {domain: 8}\nserver: {theta: 3}\n").string();
  EXPECT_THAT(first_of(read_config(server, settings)), Says(Grade::kOk, "known to the server", ""));
  EXPECT_EQ(settings.wire.domain, 8);
}

TEST_F(DoctorFiles, ConfigWithASlip) {
  AgentOptions settings;
  const std::string agent = folder_.write("agent.yaml", "id: left\nwire: {domian: 7}\n").string();
  EXPECT_THAT(first_of(read_config(agent, settings)),
              Says(Grade::kFail, agent + ":2: wire.domian: unknown key, did you mean 'domain'?", "--print-config"));
  EXPECT_THAT(first_of(read_config((folder_ / "none.yaml").string(), settings)), Says(Grade::kFail, "none.yaml", ""));
}

}  // namespace
}  // namespace coslam::doctor::files_test
