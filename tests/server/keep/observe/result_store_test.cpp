// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/result_store.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <iterator>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/dataset/trajectory.h"
#include "tests/support/sim_run.h"
#include "tests/support/temp_folder.h"

namespace coslam::result_store_test {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr int kFrames = 60;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Looks to its side, at nothing that a camera on the other side sees.
test::CameraPath aside(double side) {
  return [=](double t_s) {
    const Eigen::Vector3d center_m(side * 0.9 + 0.6 * std::sin(1.3 * t_s + side), 0.15 * std::sin(2 * t_s),
                                   0.2 * std::sin(t_s));
    return test::looking(center_m, side * 0.9);
  };
}

// Two cameras, each in a map of its own, and a third in that of the first.
class ResultStoreTest : public ::testing::Test {
 protected:
  ResultStoreTest() {
    for (const double side : {-1.0, 1.0, -1.1}) run_.add_agent(aside(side));
  }
  void map_all(ResultStore& store) {
    for (int i = 0; i < kFrames; ++i) {
      run_.step();
      store.record(run_.last_set(), run_.server());
    }
  }
  nlohmann::ordered_json report() const {
    nlohmann::ordered_json report{{"agents", {{"cam0", {}}, {"cam1", {}}, {"cam2", {}}}},
                                  {"maps", nlohmann::json::array()}};
    for (const MapFrames& m : run_.server().maps()) {
      nlohmann::json agents;
      for (const auto& [camera, frames] : m.frames) agents[run_.server().map().camera(camera).name] = frames;
      report["maps"].push_back({{"map", m.map.value}, {"agents", agents}});
    }
    return report;
  }
  std::size_t points_in(MapId map) const {
    return static_cast<std::size_t>(
        std::ranges::count_if(run_.map().points(), [&](const auto& p) { return p.second.map == map; }));
  }
  void expect_two_maps() const {
    const ResultContents contents = contents_of(result_);
    ASSERT_THAT(contents.maps, SizeIs(2));
    EXPECT_THAT(contents.maps[0].agents, ::testing::ElementsAre("cam0", "cam2"));
    EXPECT_THAT(contents.maps[1].agents, ::testing::ElementsAre("cam1"));
    for (const ResultMap& map : contents.maps) {
      EXPECT_EQ(read_points(map.folder.points()).size(), points_in(map.id)) << map.folder.path();
      EXPECT_GT(points_in(map.id), 100U);
      EXPECT_TRUE(std::filesystem::exists(map.folder.map()));
      EXPECT_TRUE(std::filesystem::exists(map.folder.dynamic()));
      EXPECT_TRUE(std::filesystem::exists(map.folder.objects()));
      for (const std::string& agent : map.agents) {
        EXPECT_GT(load_tum(map.folder.trajectory(agent)).size(), 40U) << map.folder.path() << " " << agent;
        EXPECT_GT(load_tum(map.folder.live(agent)).size(), 20U) << map.folder.path() << " " << agent;
      }
    }
    EXPECT_TRUE(load_tum(result_.trajectory("cam1")).empty()) << "it was never in the common map";
  }

  const test::SimWorld world_{{.points = 900}};
  mutable test::SimRun run_{world_, {}};
  const test::TempFolder temp_;
  const ResultFolder result_{temp_ / "out"};
};

TEST_F(ResultStoreTest, WritesEachMapByItself) {
  ResultStore store(result_.path());
  map_all(store);
  run_.server().finish();
  store.finish(run_.server(), report());
  expect_two_maps();
}

TEST_F(ResultStoreTest, TheFirstOfTwoResultsIsWhole) {
  ResultStore store(result_.path());
  map_all(store);
  store.write(run_.server(), report());
  expect_two_maps();
  EXPECT_THAT(text_of(result_.events()), HasSubstr("end,run_is_over"));
  const std::string first = text_of(result_.trajectory("cam0")), tracks = text_of(result_.tracks("cam0"));
  run_.server().finish();
  store.finish(run_.server(), report());
  expect_two_maps();
  EXPECT_NE(text_of(result_.trajectory("cam0")), first) << "now it is adjusted";
  EXPECT_EQ(text_of(result_.tracks("cam0")), tracks);
  const std::string events = text_of(result_.events());
  EXPECT_EQ(events.find(",end,"), events.rfind(",end,")) << "one end";
}

TEST_F(ResultStoreTest, AKillAfterTheFirstLeavesIt) {
  const auto die = [this] {
    ResultStore store(result_.path());
    map_all(store);
    store.write(run_.server(), report());
    run_.server().finish();
    std::raise(SIGKILL);
  };
  EXPECT_EXIT(die(), ::testing::KilledBySignal(SIGKILL), "");
  ResultStore unused(temp_ / "other");  // to have the same map here
  map_all(unused);
  expect_two_maps();
}

TEST_F(ResultStoreTest, AFolderHoldsOneRun) {
  temp_.write("out/groups.csv", "of another run");
  EXPECT_THAT(test::error_of<UserError>([&] { ResultStore(result_.path()); }), HasSubstr("holds a run already"));
  EXPECT_EQ(text_of(result_.groups()), "of another run");
}

// Each full file is said once, mapping goes on, and at the end one sentence says what is missing.
TEST_F(ResultStoreTest, AFullDiskCostsOnlyWhatHasNoRoom) {
  ResultStore store(result_.path());
  std::filesystem::create_symlink("/dev/full", result_.tracks("cam0"));
  std::filesystem::create_symlink("/dev/full", result_.points().string() + ".new");
  std::filesystem::create_directory(result_.tracks("cam1"));  // cannot be made at all
  init_log("test");                                           // to standard error
  ::testing::internal::CaptureStderr();
  map_all(store);
  const auto sentence = test::error_of<UserError>([&] { store.write(run_.server(), report()); });
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, HasSubstr(result_.tracks("cam1").string() + ": cannot be written: Is a directory"));
  EXPECT_EQ(said.find("cam1.csv"), said.rfind("cam1.csv")) << "once: " << said;
  EXPECT_THAT(sentence, HasSubstr("No space left on device; nor can 2 more files of the result"));
  EXPECT_GT(load_tum(result_.trajectory("cam0")).size(), 40U);
  EXPECT_TRUE(std::filesystem::exists(result_.map()));
  EXPECT_TRUE(std::filesystem::exists(result_.report()));
  EXPECT_FALSE(std::filesystem::exists(result_.points()));
}

}  // namespace
}  // namespace coslam::result_store_test
