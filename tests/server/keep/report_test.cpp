// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/report.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/fleet/record/link_to_nobody.h"
#include "tests/support/sim_map.h"

namespace coslam::report_test {
namespace {

using testing::Each;
using Json = nlohmann::ordered_json;

constexpr CameraId kCam0(0), kCam1(1);

// A link over which so much went.
class UsedLink : public LinkToNobody {
 public:
  std::optional<ServerEvent> next_event(std::chrono::milliseconds) override { return std::nullopt; }
  LinkBytes bytes(const std::string& agent) const override {
    return agent == "cam0" ? LinkBytes{3000, 1500} : LinkBytes{};
  }
  ServerLinkCounts counts() const override { return {.dropped_frames = 5, .late_replies = 6, .resent_patches = 7}; }
  const RejectionCounts& rejections() const override { return rejections_; }

  RejectionCounts rejections_;
};

// The map of two cameras, as a file has it. The first has no pose in sets 3 to 5 and in the last two of ten.
class ReportTest : public testing::Test {
 protected:
  ReportTest() {
    for (std::uint32_t i = 0; i < 10; ++i) {
      sim_.ingest();
      sim_.place_truly(kCam1);
      if ((i < 3 || i > 5) && i < 8) sim_.place_truly(kCam0);
      if (i == 1) sim_.add_points();
    }
    agents_ = {{.name = "cam0", .camera = kCam0}, {.name = "cam1", .camera = kCam1}};
    agents_[0].images[ImageFate::kTracked] = 5;
    agents_[0].images[ImageFate::kWithoutPose] = 5;
    agents_[0].images[ImageFate::kNotSent] = 10;
    agents_[1].images[ImageFate::kTracked] = 10;
  }
  // As it is in a server now.
  MapServer server() const {
    Tables tables;
    for (Row& row : MapRows().changes(sim_.map)) tables[row.table][row.key] = std::move(row.bytes);
    MapServer out(RunId(1), {});
    out.restore(tables, 0);
    out.meet_all();
    return out;
  }
  Json report() const {
    return make_report(server(), link_, {.late = 2, .overflowed = 3, .sets_left_out = 4, .stamps = stamps_}, agents_,
                       true, {{"server", {{"threads", 1}}}});
  }

  const test::SimWorld world_{{.points = 60}};
  test::SimMap sim_{world_, test::paths_side_by_side(2)};
  UsedLink link_;
  const StampWatch stamps_{{0}};
  std::vector<ReportedAgent> agents_;
};

TEST_F(ReportTest, OfAMapAloneTellsWhoIsInIt) {
  const Json map = make_map_report(server());
  EXPECT_FALSE(map["version"].get<std::string>().empty());
  ASSERT_EQ(map["agents"].size(), 2U);
  EXPECT_EQ(map["agents"]["cam0"]["frames"], 10);
  EXPECT_EQ(map["agents"]["cam0"]["tracked_percent"], 50);
  EXPECT_EQ(map["agents"]["cam1"]["tracked_percent"], 100);
  EXPECT_TRUE(map["agents"]["cam1"]["misdated_s"].is_null());
  ASSERT_EQ(map["maps"].size(), 1U);
  EXPECT_EQ(map["maps"][0]["map"], sim_.id.value);
  EXPECT_EQ(map["maps"][0]["agents"], Json({{"cam0", 5}, {"cam1", 10}}));
  EXPECT_EQ(map["maps"][0]["points"]["static"], sim_.map.points().size());
  EXPECT_EQ(map["maps"][0]["scale_known"], false);
  EXPECT_EQ(make_map_report(MapServer(RunId(1), {}))["agents"], Json::object());
}

TEST_F(ReportTest, TimesWithoutAPoseAreInPlayedSeconds) {
  const Json lost = make_map_report(server())["agents"]["cam0"]["lost_intervals"];
  ASSERT_EQ(lost.size(), 2U);
  EXPECT_NEAR(lost[0][0].get<double>(), 3 / 30.0, 1e-6);
  EXPECT_NEAR(lost[0][1].get<double>(), 6 / 30.0, 1e-6);
  EXPECT_NEAR(lost[1][0].get<double>(), 8 / 30.0, 1e-6);
  EXPECT_NEAR(lost[1][1].get<double>(), 9 / 30.0, 1e-6) << "until the last image";
  EXPECT_EQ(make_map_report(server())["agents"]["cam1"]["lost_intervals"], Json::array());
}

TEST_F(ReportTest, WhatLeftTheMemoryOfALongRunCountsAsBefore) {
  const Json before = make_map_report(server());
  sim_.edit.take_frames(sim_.map.camera(kCam0), SetId(7), {});
  const Json after = make_map_report(server());
  for (const char* name : {"frames", "tracked_percent", "lost_intervals"}) {
    EXPECT_EQ(after["agents"]["cam0"][name], before["agents"]["cam0"][name]) << name;
  }
  EXPECT_EQ(after["maps"][0]["agents"], before["maps"][0]["agents"]);
}

TEST_F(ReportTest, ImagesAreThoseThatTheSourcesGave) {
  const Json all = report();
  EXPECT_EQ(all["frames"], 30);
  EXPECT_EQ(all["dropped"], 10);
  EXPECT_EQ(all["images"]["tracked"], 15);
  EXPECT_EQ(all["agents"]["cam0"]["frames"], 20);
  EXPECT_EQ(all["agents"]["cam0"]["frames_received"], 10);
  EXPECT_EQ(all["agents"]["cam0"]["tracked_percent"], 25);
  EXPECT_FALSE(all.contains("problem"));
}

TEST_F(ReportTest, TheLinkTellsWhatItCarriedLostAndRefused) {
  link_.rejections_.add(Rejection::kNotFinite);
  link_.rejections_.add(Rejection::kNotFinite);
  const Json all = report();
  EXPECT_EQ(all["agents"]["cam0"]["bytes_up"], 3000);
  EXPECT_NEAR(all["agents"]["cam0"]["kb_per_s_up"].get<double>(), 3.0 / (9 / 30.0), 1e-3);
  EXPECT_NEAR(all["agents"]["cam0"]["kb_per_s_down"].get<double>(), 1.5 / (9 / 30.0), 1e-3);
  EXPECT_EQ(all["agents"]["cam1"]["kb_per_s_up"], 0);
  EXPECT_EQ(all["link"], Json({{"dropped_frames", 5}, {"late_replies", 6}, {"resent_patches", 7}}));
  EXPECT_EQ(all["rejected"], Json({{"not_finite", 2}})) << "only what there was";
  EXPECT_EQ(all["late_frames"], 2);
  EXPECT_EQ(all["overflowed_frames"], 3);
  EXPECT_EQ(all["frame_sets_left_out"], 4);
  EXPECT_EQ(all["adjusted"], true);
  EXPECT_EQ(all["configuration"]["server"]["threads"], 1);
}

TEST_F(ReportTest, WhereNothingWasMappedItSaysWhy) {
  for (ReportedAgent& a : agents_) {
    a.images = {};
    a.problem = a.name + " saw nothing";
  }
  EXPECT_EQ(report()["problem"], "nothing was mapped: cam0 saw nothing; cam1 saw nothing");
  EXPECT_EQ(report()["agents"]["cam0"]["problem"], "cam0 saw nothing");
  agents_[0].images[ImageFate::kInOtherMaps] = 1;
  EXPECT_FALSE(report().contains("problem"));
}

TEST_F(ReportTest, AnAgentSaysWhatItLikesOfItselfAndNoMore) {
  agents_[0].last_status.report_json =
      R"({"ms": {"track": {"p50": 3}}, "frames": 999, "path": "best", "bytes_up": -1, "images": "all"})";
  const Json agent = report()["agents"]["cam0"];
  EXPECT_EQ(agent["ms"]["track"]["p50"], 3);
  EXPECT_EQ(agent["frames"], 20) << "which the server counted";
  EXPECT_EQ(agent["bytes_up"], 3000);
  EXPECT_EQ(agent["images"]["tracked"], 5);
  EXPECT_TRUE(agent["path"].is_null()) << "the map was not adjusted as a whole";
}

TEST_F(ReportTest, AnAgentThatSaysNonsenseSpoilsNothing) {
  const std::string deep = R"({"a": )" + std::string(100'000, '[') + std::string(100'000, ']') + "}";
  const Json without = report()["agents"];
  for (const std::string& nonsense : {std::string("{"), std::string("[1, 2]"), std::string("7"), std::string("null"),
                                      std::string("\"text\""), std::string("{\"a\": \"\xff\"}"),
                                      std::string("{\"a\": 1e999}"), std::string(1, '\0'), std::string(100'000, '[')}) {
    agents_[0].last_status.report_json = nonsense;
    const Json all = report();
    EXPECT_EQ(all["agents"], without) << nonsense.substr(0, 20);
    EXPECT_FALSE(all.dump().empty());
  }
  agents_[0].last_status.report_json = deep;
  EXPECT_LT(report().dump().size(), 100'000U) << "what is too deep is left out";
}

TEST_F(ReportTest, APointThatMovesIsDynamic) {
  sim_.set_moving(sim_.map.points().begin()->second);
  const Json points = report()["server"]["points"];
  EXPECT_EQ(points["dynamic"], 1);
  EXPECT_EQ(points["static"], sim_.map.points().size() - 1);
}

TEST_F(ReportTest, ALensIsTheCalibrationUntilSomethingIsFoundWrong) {
  EXPECT_EQ(report()["agents"]["cam0"]["lens"]["corrected"], false);
  EXPECT_EQ(report()["agents"]["cam0"]["lens"]["focal_ratio"], 1);
  LensCorrection lens;
  lens.values[0] = 0.05;
  sim_.edit.correct_lens(sim_.map.camera(kCam0), lens, LensCorrection::Values::Constant(0.01));
  const Json found = report()["agents"]["cam0"];
  EXPECT_EQ(found["lens"]["corrected"], true);
  EXPECT_NEAR(found["lens"]["focal_ratio"].get<double>(), std::exp(0.05), 1e-6);
  EXPECT_NEAR(found["lens"]["focal_sigma"].get<double>(), 0.01, 1e-9);
  EXPECT_EQ(found["camera"]["fx"], sim_.map.camera(kCam0).model.fx) << "as it was given";
  EXPECT_NEAR(found["lens"]["fx"].get<double>(), std::exp(0.05) * sim_.map.camera(kCam0).model.fx, 0.1);
}

std::uint64_t faults(const std::string& report_json, ImageFault fault) {
  return faults_of(report_json)[static_cast<std::size_t>(fault)];
}

TEST(FaultsOfAnAgent, AreCountedByTheirNames) {
  const std::string good = R"({"left_out": {"unreadable": 3, "cut_off": 2, "another": 9}})";
  EXPECT_EQ(faults(good, ImageFault::kUnreadable), 3U);
  EXPECT_EQ(faults(good, ImageFault::kCutOff), 2U);
  EXPECT_EQ(faults(good, ImageFault::kRepeated), 0U);
}

TEST(FaultsOfAnAgent, AreNoneWhereItTellsNoNumbers) {
  for (const std::string& odd :
       {std::string(), std::string("x"), std::string("[]"), std::string("{}"), std::string(R"({"left_out": 3})"),
        std::string(R"({"left_out": [3]})"), std::string(R"({"left_out": {"unreadable": -3}})"),
        std::string(R"({"left_out": {"unreadable": "3"}})"), std::string(R"({"left_out": {"unreadable": 1.5}})"),
        std::string(R"({"left_out": {"unreadable": {"deep": 3}}})")}) {
    EXPECT_THAT(faults_of(odd), Each(0U)) << odd;
  }
}

}  // namespace
}  // namespace coslam::report_test
