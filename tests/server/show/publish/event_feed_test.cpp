// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/publish/event_feed.h"

#include <gmock/gmock.h>

#include "server/estimator/map/edit.h"

namespace coslam::event_feed_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> kinds(const std::vector<PublicEvent>& events) {
  std::vector<std::string> out;
  for (const PublicEvent& e : events) out.push_back(e.kind);
  return out;
}

class HappeningsTest : public ::testing::Test {
 protected:
  HappeningsTest() {
    for (int i = 0; i < 4; ++i) edit_.add_camera("cam" + std::to_string(i), RunId(10U + static_cast<unsigned>(i)), {});
  }
  static CameraId camera(int i) { return CameraId(static_cast<std::uint16_t>(i)); }
  std::vector<PublicEvent> after(const std::vector<Event>& events, const ViewGraph& graph = {}) {
    Journal journal;
    for (const Event& e : events) journal.note(e);
    return happenings_.after_set(edit_.map(), journal, graph);
  }
  static ViewGraph groups(const std::vector<std::vector<int>>& of) {
    ViewGraph graph;
    for (const auto& group : of) {
      auto& cameras = graph.groups.emplace_back();
      for (const int i : group) cameras.push_back(camera(i));
    }
    return graph;
  }

  MapEdit edit_{MapConfig{}};
  EventFeed happenings_;
};

TEST_F(HappeningsTest, WhoComesAndGoes) {
  EXPECT_THAT(kinds(happenings_.comings(edit_.map())), ElementsAre("joined", "joined", "joined", "joined"));
  EXPECT_THAT(happenings_.comings(edit_.map()), IsEmpty());
  edit_.set_alive(camera(1), false);
  const auto left = happenings_.comings(edit_.map());
  ASSERT_THAT(kinds(left), ElementsAre("left"));
  EXPECT_THAT(left[0].agents, ElementsAre("cam1"));
  EXPECT_THAT(happenings_.why_lost(edit_.map().camera(camera(1))), HasSubstr("gone"));
  edit_.set_alive(camera(1), true);
  EXPECT_THAT(happenings_.comings(edit_.map())[0].text, HasSubstr("is back"));
  edit_.restart_camera(camera(2), RunId(77), {});
  EXPECT_THAT(kinds(happenings_.comings(edit_.map())), ElementsAre("restarted"));
}

TEST_F(HappeningsTest, LossesHaveTheirReason) {
  after({});
  const Event lost{
      .kind = EventKind::kCameraLost, .why = Why::kNoPose, .map = MapId(1), .camera = camera(0), .figures = {40, 7}};
  const auto events = after({lost});
  ASSERT_THAT(kinds(events), ElementsAre("lost"));
  EXPECT_EQ(events[0].text,
            "cam0 is lost because too few of the 40 known points that it sees agree with any pose (7 do)");
  EXPECT_THAT(happenings_.why_lost(edit_.map().camera(camera(0))), HasSubstr("40 known points"));
  const Event found{.kind = EventKind::kCameraFound,
                    .why = Why::kPoseAgain,
                    .map = MapId(1),
                    .camera = camera(0),
                    .figures = {12, 0}};
  EXPECT_EQ(after({found})[0].text, "cam0 is found again after 12 frame sets without one");
  EXPECT_THAT(happenings_.why_lost(edit_.map().camera(camera(0))), HasSubstr("no place in any map"));
}

TEST_F(HappeningsTest, WhoseStampsAreOffIsSaidWithWhatToDo) {
  after({});
  const Event early{.kind = EventKind::kCameraMisdated,
                    .why = Why::kMovesAtOtherTimes,
                    .map = MapId(1),
                    .camera = camera(1),
                    .figures = {0.5, 2}};
  const auto events = after({early});
  ASSERT_THAT(kinds(events), ElementsAre("misdated"));
  EXPECT_THAT(events[0].text, HasSubstr("cam1's images seem to be taken 0.5 s later than they are dated"));
  EXPECT_THAT(events[0].text, HasSubstr("those of cam2"));
  EXPECT_THAT(events[0].text, HasSubstr("less start_s"));
  EXPECT_THAT(events[0].agents, ElementsAre("cam1", "cam2"));
}

TEST_F(HappeningsTest, MapsThatStartMeetAndClose) {
  after({});
  const auto events = after(
      {{.kind = EventKind::kMapStarted, .why = Why::kStartedTogether, .map = MapId(2), .figures = {3, 0}},
       {.kind = EventKind::kMapMerged, .why = Why::kMapsMet, .map = MapId(1), .from = MapId(2), .figures = {1.5, 0}},
       {.kind = EventKind::kMapMoved, .why = Why::kLoopClosed, .map = MapId(1), .figures = {1, 0}},
       {.kind = EventKind::kMapMoved, .why = Why::kAdjusted, .map = MapId(1)}});
  EXPECT_THAT(kinds(events), ElementsAre("map_started", "maps_joined", "loop"));
  EXPECT_THAT(events[1].text, HasSubstr("Map 2 became part of map 1"));
}

TEST_F(HappeningsTest, GroupsMergeAndSplit) {
  after({});
  const auto merged = after({}, groups({{0, 1}, {2}, {3}}));
  ASSERT_THAT(kinds(merged), ElementsAre("merge"));
  EXPECT_EQ(merged[0].text, "cam0 and cam1 share a view now");
  EXPECT_THAT(merged[0].agents, ElementsAre("cam0", "cam1"));
  EXPECT_THAT(after({}, groups({{0, 1}, {2}, {3}})), IsEmpty());
  const auto more = after({}, groups({{0, 1, 2, 3}}));
  ASSERT_THAT(kinds(more), ElementsAre("merge"));
  EXPECT_THAT(more[0].text, HasSubstr("[cam0 and cam1]"));
  EXPECT_THAT(kinds(after({}, groups({{0, 1}, {2, 3}}))), ElementsAre("split"));
  edit_.set_alive(camera(3), false);
  EXPECT_THAT(kinds(after({}, groups({{0, 1}, {2}}))), ElementsAre("left")) << "a group does not split when one leaves";
}

}  // namespace
}  // namespace coslam::event_feed_test
