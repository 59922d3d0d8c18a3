// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/event_store.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "server/estimator/map/edit.h"
#include "tests/support/temp_folder.h"

namespace coslam::event_store_test {
namespace {

using ::testing::ElementsAre;

struct Line {
  std::string kind, why, camera, to;
  SetId set;
  std::optional<double> a, b;
};

std::vector<Line> lines_of(const std::filesystem::path& file) {
  std::vector<Line> lines;
  for_each_event_row(file, [&](const EventRow& r) {
    lines.push_back(
        {std::string(r.kind), std::string(r.why), std::string(r.camera), std::string(r.to), r.set, r.a, r.b});
    return true;
  });
  return lines;
}

std::vector<std::string> kinds_of(const std::filesystem::path& file) {
  std::vector<std::string> kinds;
  for (const Line& l : lines_of(file)) kinds.push_back(l.kind);
  return kinds;
}

class EventStoreTest : public ::testing::Test {
 protected:
  CameraId hello(const std::string& name) { return edit_.add_camera(name, RunId(1), CameraModel()); }
  void make_points(int n) {
    for (int i = 0; i < n; ++i) {
      edit_.create_point(MapId(1), Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity(), PointPhase::kTrial,
                         Why::kTwoCamerasNow, {2, 0.125});
    }
  }
  void record(EventStore& store, std::uint32_t set) {
    store.record(SetId(set), set * 100'000'000LL, edit_.journal(), edit_.map());
  }
  // As the server's step does.
  void step(EventStore& store, std::uint32_t set, int points) {
    edit_.journal().begin_set();
    edit_.ingest({SetId(set), set * 100'000'000LL, {}});
    make_points(points);
    edit_.journal().end_set();
    record(store, set);
  }

  test::TempFolder temp_;
  std::filesystem::path file_ = temp_ / "events.csv";
  MapEdit edit_{MapConfig()};
};

TEST_F(EventStoreTest, WritesEachEventOnce) {
  EventStore store(file_, {});
  hello("left");
  step(store, 0, 1);
  hello("right");  // between two sets
  step(store, 1, 0);
  edit_.journal().begin_set();  // the server's finish
  edit_.remove_point(edit_.map().points().begin()->second, Why::kTooFewViews, {1, 0});
  store.finish(edit_.journal(), edit_.map());
  EXPECT_THAT(kinds_of(file_), ElementsAre("camera_joined", "point_made", "camera_joined", "point_removed", "end"));
  const std::vector<Line> lines = lines_of(file_);
  EXPECT_EQ(lines[0].camera, "left");
  EXPECT_EQ(lines[1].to, "trial");
  EXPECT_EQ(lines[1].a, std::nullopt) << "the reason does not speak of it";
  EXPECT_EQ(lines[1].b, 0.125);
  EXPECT_EQ(lines[2].camera, "right");
  EXPECT_EQ(lines[2].set, SetId(1)) << "it takes part from there on";
  EXPECT_EQ(lines[3].why, "too_few_views");
  EXPECT_EQ(lines[3].a, 1);
  EXPECT_EQ(lines[4].why, "run_is_over");
}

TEST_F(EventStoreTest, EndsAtItsBound) {
  EventStore store(file_, {.most_mb = 0.002});
  for (std::uint32_t set = 0; set < 10; ++set) step(store, set, 5);
  const auto warning = store.take_warning();
  ASSERT_TRUE(warning.has_value());
  EXPECT_THAT(*warning, ::testing::HasSubstr("0.002 MB of server.events.most_mb"));
  step(store, 10, 5);
  EXPECT_EQ(store.take_warning(), std::nullopt);
  store.finish(edit_.journal(), edit_.map());
  EXPECT_LE(std::filesystem::file_size(file_), 2000U);
  EXPECT_GT(std::filesystem::file_size(file_), 1500U);
  const std::vector<Line> lines = lines_of(file_);
  EXPECT_EQ(lines.back().kind, kEventsEnd);
  EXPECT_EQ(lines.back().why, "file_is_full");
  EXPECT_EQ(lines[lines.size() - 2].kind, "point_made");
}

TEST_F(EventStoreTest, AnEndForNowGivesWayToWhatComesAfter) {
  EventStore store(file_, {});
  step(store, 0, 1);
  store.end_for_now();
  EXPECT_THAT(kinds_of(file_), ElementsAre("point_made", "end"));
  edit_.journal().begin_set();  // the server's finish
  edit_.remove_point(edit_.map().points().begin()->second, Why::kTooFewViews, {1, 0});
  store.finish(edit_.journal(), edit_.map());
  EXPECT_THAT(kinds_of(file_), ElementsAre("point_made", "point_removed", "end"));
}

TEST_F(EventStoreTest, AnEndAtTheBoundIsTheLast) {
  EventStore store(file_, {.most_mb = 0.002});
  for (std::uint32_t set = 0; set < 10; ++set) step(store, set, 5);
  store.end_for_now();
  const auto lines = lines_of(file_).size();
  store.finish(edit_.journal(), edit_.map());
  EXPECT_EQ(lines_of(file_).size(), lines);
  EXPECT_EQ(lines_of(file_).back().why, "file_is_full");
}

TEST_F(EventStoreTest, SwitchedOffMakesNoFile) {
  EventStore store(file_, {.enabled = false});
  EXPECT_FALSE(std::filesystem::exists(file_));
  edit_.journal().enable(false);
  step(store, 0, 3);
  EXPECT_TRUE(edit_.journal().events().empty());
  store.finish(edit_.journal(), edit_.map());
  EXPECT_FALSE(std::filesystem::exists(file_));
}

}  // namespace
}  // namespace coslam::event_store_test
