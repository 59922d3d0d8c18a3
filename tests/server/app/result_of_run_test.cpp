// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// When and where the server's loop writes its result.
#include <gmock/gmock.h>

#include <functional>
#include <memory>

#include "common/base/error.h"
#include "common/dataset/result.h"
#include "deploy/coslam/run/inline_link.h"
#include "server/app/server_loop.h"
#include "tests/support/temp_folder.h"
#include "tests/support/wire_values.h"

namespace coslam::result_of_run_test {
namespace {

using namespace std::chrono_literals;
using ::testing::EndsWith;

// A link that is at work, or refused, when the test says so.
class GatedLink : public ServerLink {
 public:
  explicit GatedLink(ServerLink& inner) : inner_(inner) {}
  std::optional<ServerEvent> next_event(std::chrono::milliseconds timeout) override {
    if (refused) throw UserError("another map server is at work");
    return works ? inner_.next_event(timeout) : std::nullopt;
  }
  bool at_work() const override { return works; }
  void send(const ServerMessage& message) override { inner_.send(message); }
  void send_status(const ServerStatus& status) override {
    inner_.send_status(status);
    if (status.stopping && at_stop) at_stop();
  }
  void refuse(const Hello& hello, const std::string& reason) override { inner_.refuse(hello, reason); }
  LinkBytes bytes(const std::string& agent) const override { return inner_.bytes(agent); }
  ServerLinkCounts counts() const override { return inner_.counts(); }
  const RejectionCounts& rejections() const override { return inner_.rejections(); }

  bool works = true, refused = false;
  std::function<void()> at_stop;

 private:
  ServerLink& inner_;
};

class ResultOfRun : public ::testing::Test {
 protected:
  // A server with this run id, from here to its end; one agent joins it, or none.
  void serve(std::uint64_t run, bool with_agent, const ServerLoopConfig& config) {
    InlineLink link{RunId(run)};
    GatedLink gated(link.server());
    ServerLoop loop(gated, RunId(run), config);
    std::unique_ptr<AgentLink> agent;
    if (with_agent) agent = link.connect(values_.hello("cam0", RunId(9), Pacing::kLive));
    EXPECT_TRUE(loop.poll(0ms));
    loop.finish({});
  }
  ServerLoopConfig in_runs() const { return {.result = {.folder = {}, .runs = runs_}, .refine_in_thread = false}; }
  long entries() const { return std::distance(std::filesystem::directory_iterator(runs_), {}); }

  test::WireValues values_{1};
  const test::TempFolder temp_;
  const std::filesystem::path runs_ = temp_ / "runs";
};

TEST_F(ResultOfRun, ARefusedServerTouchesNothing) {
  for (const ServerLoopConfig& config :
       {in_runs(), ServerLoopConfig{.result = {.folder = temp_ / "out", .runs = {}}, .refine_in_thread = false}}) {
    InlineLink link{RunId(1)};
    GatedLink gated(link.server());
    gated.works = false;
    ServerLoop loop(gated, RunId(1), config);
    EXPECT_TRUE(loop.poll(0ms)) << "it waits to hear of another server";
    EXPECT_TRUE(std::filesystem::is_empty(temp_.path()));
    gated.refused = true;
    EXPECT_NE(test::error_of<UserError>([&] { loop.poll(0ms); }), "");
    EXPECT_TRUE(std::filesystem::is_empty(temp_.path()));
  }
}

TEST_F(ResultOfRun, EachHasAFolderOfItsOwn) {
  serve(0xab, true, in_runs());
  const auto first = find_result(runs_).path();
  EXPECT_THAT(first.string(), EndsWith("Z-00000000000000ab"));
  EXPECT_EQ(read_json(ResultFolder(first).report())["agents"].size(), 1U);
  serve(0xcd, true, in_runs());
  EXPECT_THAT(find_result(runs_).path().string(), EndsWith("Z-00000000000000cd"));
  EXPECT_TRUE(std::filesystem::exists(ResultFolder(first).report())) << "the one before stays";
  EXPECT_EQ(entries(), 3);
}

TEST_F(ResultOfRun, OneThatNobodyJoinedHasNone) {
  serve(0xab, true, in_runs());
  serve(0xcd, false, in_runs());
  EXPECT_THAT(find_result(runs_).path().string(), EndsWith("Z-00000000000000ab"));
  EXPECT_EQ(entries(), 2);
}

TEST_F(ResultOfRun, IsWrittenBeforeTheMapIsAdjustedAndAfter) {
  const ResultFolder result(temp_ / "out");
  InlineLink link{RunId(1)};
  GatedLink gated(link.server());
  ServerLoop loop(gated, RunId(1), {.result = {.folder = result.path(), .runs = {}}, .refine_in_thread = false});
  EXPECT_TRUE(loop.poll(0ms));
  EXPECT_FALSE(std::filesystem::exists(result.report()));
  int stops = 0;
  gated.at_stop = [&] {
    ++stops;
    EXPECT_EQ(read_json(result.report())["adjusted"], false);
    EXPECT_TRUE(std::filesystem::exists(result.points()));
  };
  loop.finish({});
  EXPECT_EQ(stops, 1);
  EXPECT_EQ(read_json(result.report())["adjusted"], true);
}

TEST_F(ResultOfRun, ThatHasNoRoomIsAnErrorAtTheEnd) {
  const ResultFolder result(temp_ / "out");
  InlineLink link{RunId(1)};
  ServerLoop loop(link.server(), RunId(1),
                  {.result = {.folder = result.path(), .runs = {}}, .refine_in_thread = false});
  EXPECT_TRUE(loop.poll(0ms));
  std::filesystem::create_directory(result.report());
  EXPECT_THAT(test::error_of<UserError>([&] { loop.finish({}); }),
              ::testing::HasSubstr("report.json: cannot be written"));
  EXPECT_TRUE(std::filesystem::exists(result.points()));
}

}  // namespace
}  // namespace coslam::result_of_run_test
