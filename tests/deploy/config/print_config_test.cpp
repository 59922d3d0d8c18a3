// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What --print-config prints of all keys of both programs.
#include <gmock/gmock.h>

#include <regex>
#include <sstream>

#include "agent/agent_options.h"
#include "common/base/error.h"
#include "common/config/config.h"
#include "server/app/server_options.h"
#include "tests/support/temp_folder.h"

namespace coslam::print_config_test {
namespace {

using ::testing::HasSubstr;

// Gives every key a value that it does not have by default, numbers with all their digits.
class ChangeAll {
 public:
  void field(const std::string&, int& value, config::Bounds<int> b, const std::string&) {
    value = value == b.max ? b.min : b.max;
    ++keys_;
  }
  void field(const std::string&, double& value, config::Bounds<double> b, const std::string&) {
    const double third = b.min + (b.max - b.min) / 3;
    value = value == third ? b.max : third;
    ++keys_;
  }
  void field(const std::string&, bool& value, const std::string&) {
    value = !value;
    ++keys_;
  }
  void field(const std::string& name, std::string& value, const std::string&) {
    value = name + ": 'a' \"b\" \\c # {d}, [e]";
    ++keys_;
  }
  void field(const std::string&, std::string& value, const std::vector<std::string>& allowed, const std::string&) {
    value = value == allowed.front() ? allowed.back() : allowed.front();
    ++keys_;
  }
  void field(const std::string& name, std::vector<std::string>& value, const std::string&) {
    value = {name, "", "a, b", "10.0.0.1", "# c"};
    ++keys_;
  }
  void field(const std::string& name, std::vector<std::string>& value, config::Fields::ReadSection,
             const std::string& comment) {
    field(name, value, comment);
  }
  template <class Section>
  void section(const std::string&, Section& section) {
    describe(*this, section);
  }
  int keys() const { return keys_; }

 private:
  int keys_ = 0;
};

template <class Options>
class PrintConfig : public ::testing::Test {
 protected:
  Options read_back(const Options& options) const {
    Options read;
    config::load(read, folder_.write("printed.yaml", config::dump_yaml(options)));
    return read;
  }
  test::TempFolder folder_;
};

using Programs = ::testing::Types<ServerOptions, AgentOptions>;
TYPED_TEST_SUITE(PrintConfig, Programs);

// Both dumps hold numbers so that no bit is lost: equal texts are equal values.
TYPED_TEST(PrintConfig, ReadsBackExactly) {
  TypeParam options;
  const std::string defaults = config::dump_yaml(options);
  EXPECT_EQ(config::dump_yaml(this->read_back(options)), defaults);

  ChangeAll change;
  describe(change, options);
  const TypeParam read = this->read_back(options);
  EXPECT_EQ(config::dump_yaml(read), config::dump_yaml(options));
  EXPECT_EQ(config::dump_json(read), config::dump_json(options));

  // Not one key kept its default: what is compared above is all keys.
  const nlohmann::json before = config::dump_json(TypeParam()).flatten(), after = config::dump_json(read).flatten();
  int changed = 0;
  for (const auto& [key, value] : before.items()) changed += after.contains(key) && after[key] == value ? 0 : 1;
  EXPECT_EQ(changed, static_cast<int>(before.size()));
  EXPECT_GE(change.keys(), changed);
}

TYPED_TEST(PrintConfig, SaysOfEachKeyWhatItMeans) {
  const std::regex section(" *[a-z0-9_]+:"), key(" *[a-z0-9_]+: [^ ].*  # [^ (].*");
  const std::regex number(" *[a-z0-9_]+: -?[0-9].*"), bounds(".* \\(-?[0-9.e+-]+ to -?[0-9.e+-]+\\)");
  std::istringstream lines(config::dump_yaml(TypeParam()));
  int keys = 0;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_match(line, section)) continue;
    ++keys;
    EXPECT_TRUE(std::regex_match(line, key)) << line;
    EXPECT_EQ(std::regex_match(line, number), std::regex_match(line, bounds)) << line;
  }
  TypeParam options;
  ChangeAll all;
  describe(all, options);
  EXPECT_EQ(keys, all.keys());
}

TEST(PrintConfigWords, ThoseThatAreAllowed) {
  EXPECT_THAT(config::dump_yaml(AgentOptions()),
              ::testing::ContainsRegex("family: \"none\"  # .*\\(.*DICT_APRILTAG_36h11"));
}

// The keys that people are likely to get wrong, against the real ones.
TEST(UnknownKeys, OfTheServer) {
  const auto reason = [](const std::string& assignment) {
    return test::error_of<UsageError>([&] {
      ServerOptions options;
      config::apply_set(options, assignment);
    });
  };
  EXPECT_THAT(reason("theta=2"), HasSubstr("did you mean 'server.theta'?"));
  EXPECT_THAT(reason("server.map.theta=2"), HasSubstr("did you mean 'server.theta'?"));
  EXPECT_THAT(reason("server.localize.min_inliers=9"), HasSubstr("did you mean 'server.localise.min_inliers'?"));
  EXPECT_THAT(reason("localize.min_inliers=9"), HasSubstr("did you mean 'server.localise.min_inliers'?"));
  EXPECT_THAT(reason("server.deadline_s=1"), HasSubstr("did you mean 'server.sync.deadline_s'?"));
  EXPECT_THAT(reason("domain=1"), HasSubstr("did you mean 'wire.domain'?"));
}

TEST(UnknownKeys, OfTheServersFile) {
  const test::TempFolder folder;
  const auto reason = [&](const std::string& text) {
    return test::error_of<UserError>([&] {
      ServerOptions options;
      config::load(options, folder.write("server.yaml", text));
    });
  };
  EXPECT_THAT(reason("theta: 2\n"), HasSubstr("server.yaml:1: theta: unknown key, did you mean 'server.theta'?"));
  EXPECT_THAT(reason("server:\n  map:\n    theta: 2\n"),
              HasSubstr("server.yaml:2: server.map: unknown key, did you mean 'server.theta'?"));
  EXPECT_THAT(reason("server:\n  localize:\n    min_inliers: 9\n"),
              HasSubstr("server.yaml:2: server.localize: unknown key, did you mean 'localise'?"));
  EXPECT_THAT(reason("server:\n  deadline_s: 1\n"), HasSubstr("did you mean 'server.sync.deadline_s'?"));
  EXPECT_THAT(reason("agent:\n  tracker: {max_tracks: 9}\n"), HasSubstr("unknown key"));
}

}  // namespace
}  // namespace coslam::print_config_test
