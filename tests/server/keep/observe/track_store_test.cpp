// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/track_store.h"

#include <gmock/gmock.h>

#include <map>

#include "common/base/error.h"
#include "tests/support/sim_map.h"
#include "tests/support/temp_folder.h"

namespace coslam::track_store_test {
namespace {

constexpr CameraId kCam0(0);

// One camera; every image is recorded.
class TrackStoreTest : public ::testing::Test {
 protected:
  void record(TrackStore& store, int sets) {
    for (int n = 0; n < sets; ++n) {
      sim_.advance();
      store.record(sim_.set.frames.front().frame, sim_.map.camera(kCam0), sim_.map);
    }
  }
  const ServerTrack& oldest() const { return sim_.map.camera(kCam0).tracks.begin()->second; }
  std::map<std::uint32_t, std::optional<PointState>> states_of(TrackId track) const {
    std::map<std::uint32_t, std::optional<PointState>> states;
    for_each_track_row(file_, [&](const ResultTrackRow& row) {
      if (row.track == track) states[row.frame.value] = row.state;
    });
    return states;
  }

  const test::SimWorld world_{{.points = 200}};
  test::SimMap sim_{world_, test::paths_side_by_side(1)};
  const test::TempFolder temp_;
  const std::filesystem::path file_ = temp_ / "cam0.csv";
};

TEST_F(TrackStoreTest, MarksWhatWentAlongBeforeItWasFoundToMove) {
  TrackStore store(file_);
  record(store, 4);
  const TrackId track = oldest().id;
  const SetId since = sim_.set.id;
  const std::uint32_t since_frame = sim_.set.frames.front().frame.frame.value;
  record(store, 5);
  sim_.edit.set_motion(kCam0, oldest(), TrackMotion::kMoving);
  sim_.edit.mark_co_moving(oldest(), since);
  record(store, 2);
  sim_.edit.set_motion(kCam0, oldest(), TrackMotion::kResting);
  record(store, 1);
  store.file().close();
  const auto live = states_of(track);
  ASSERT_EQ(live.size(), 12U);
  store.mark_earlier_motion();
  const auto marked = states_of(track);
  ASSERT_EQ(marked.size(), live.size());
  for (const auto& [frame, state] : marked) {
    const bool earlier = frame >= since_frame && frame < since_frame + 6;
    EXPECT_EQ(state, earlier ? PointState::kDynamic : live.at(frame)) << frame;
  }
  EXPECT_FALSE(marked.rbegin()->second) << "it rests";
  const TrackId other = std::next(sim_.map.camera(kCam0).tracks.begin())->second.id;
  for (const auto& [frame, state] : states_of(other)) EXPECT_FALSE(state);
}

TEST_F(TrackStoreTest, LeavesTheFileWhereNothingIsToBeMarked) {
  TrackStore store(file_);
  record(store, 3);
  store.file().close();
  const auto written = std::filesystem::last_write_time(file_);
  store.mark_earlier_motion();
  EXPECT_EQ(std::filesystem::last_write_time(file_), written);
}

TEST_F(TrackStoreTest, AFullDiskLeavesTheFileAsItWas) {
  TrackStore store(file_);
  record(store, 2);
  sim_.edit.set_motion(kCam0, oldest(), TrackMotion::kMoving);
  sim_.edit.mark_co_moving(oldest(), SetId(0));
  record(store, 1);
  store.file().close();
  const auto before = states_of(oldest().id);
  std::filesystem::create_symlink("/dev/full", file_.string() + ".new");
  EXPECT_THROW(store.mark_earlier_motion(), UserError);
  EXPECT_EQ(states_of(oldest().id), before);
}

}  // namespace
}  // namespace coslam::track_store_test
