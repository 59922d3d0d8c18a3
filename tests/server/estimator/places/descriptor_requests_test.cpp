// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/descriptor_requests.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "tests/support/map_fit.h"
#include "tests/support/sim_map.h"

// What of the map and of other stages makes a request. How often one is made is in ask_test.cpp.
namespace coslam::descriptor_requests_test {
namespace {

using test::cam;
using Requests = std::map<CameraId, DescriptorRequest>;

// Two cameras that stand still.
class DescriptorRequestsTest : public testing::Test {
 protected:
  DescriptorRequestsTest() {
    sim_.advance();
    sim_.add_points();
  }
  Requests run(const PlaceRecognitionReport& met = {}, const ExpectedOverlapReport& expected = {}) {
    return stage_.run(sim_.map, sim_.set, {graph_}, expected, places_, met).requests;
  }
  // The first camera described its newest image.
  PlaceRecognitionReport described() const { return {.described = {{sim_.set.id, cam(0)}}}; }
  void step() {
    sim_.ingest();
    for (const MapCamera& c : sim_.map.cameras()) {
      if (c.map != MapId()) sim_.place(c.id, c.map, sim_.truth(c.id, sim_.set.id));
    }
  }
  // What the first camera is asked for in so many sets.
  std::vector<DescriptorRequest> asked_in(int sets, const ExpectedOverlapReport& expected = {}) {
    std::vector<DescriptorRequest> out;
    for (int i = 0; i < sets; ++i) {
      step();
      const Requests all = run({}, expected);
      if (const auto at = all.find(cam(0)); at != all.end()) out.push_back(at->second);
    }
    return out;
  }
  // As if it had described an image long enough ago.
  void describe_once() {
    ASSERT_TRUE(run().contains(cam(0)));
    step();
    run(described());
  }

  const test::SimWorld world_{{.points = 60}};
  test::SimMap sim_{world_,
                    {test::still_path(test::looking({-0.3, 0, 0})), test::still_path(test::looking({0.3, 0, 0}))}};
  const ViewGraph graph_;
  PlaceRecognition places_{PlaceRecognitionConfig()};
  DescriptorRequests stage_{AskConfig()};
};

TEST_F(DescriptorRequestsTest, OnlyCamerasOfThisSetAreAsked) {
  sim_.set.frames.pop_back();
  const Requests requests = run();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests.begin()->first, cam(0));
  EXPECT_EQ(requests.begin()->second, DescriptorRequest::kAtTracks) << "of what the map knows";
}

TEST_F(DescriptorRequestsTest, WhatCameNeedNotBeAskedForAgain) {
  describe_once();
  EXPECT_TRUE(asked_in(90).empty());
}

TEST_F(DescriptorRequestsTest, WhatDidNotComeIsAskedForAgain) {
  ASSERT_TRUE(run().contains(cam(0)));
  const auto asked = asked_in(90);
  EXPECT_GE(asked.size(), 1U);
  EXPECT_LE(asked.size(), 3U) << "a second apart";
}

TEST_F(DescriptorRequestsTest, CamerasOfAnotherMapAreLookedForEverywhere) {
  sim_.place(cam(1), sim_.edit.new_map(Why::kStartedAlone, 1), Rigid3());
  describe_once();
  const auto asked = asked_in(60);
  ASSERT_FALSE(asked.empty());
  for (const DescriptorRequest r : asked) EXPECT_EQ(r, DescriptorRequest::kEverywhere);
}

TEST_F(DescriptorRequestsTest, AMapWithoutALiveCameraIsNotLookedFor) {
  sim_.place(cam(1), sim_.edit.new_map(Why::kStartedAlone, 1), Rigid3());
  sim_.edit.set_alive(cam(1), false);
  describe_once();
  EXPECT_TRUE(asked_in(60).empty());
}

TEST_F(DescriptorRequestsTest, ACameraThatShouldSeeWhatAnotherSeesIsAskedThoughItsViewIsTheSame) {
  describe_once();
  EXPECT_FALSE(asked_in(30, {{{cam(0), {cam(1)}}}}).empty());
}

TEST_F(DescriptorRequestsTest, AHintIsLookedAtEverywhereForAWhile) {
  describe_once();
  for (int i = 0; i < 6; ++i) step();
  const PlaceRecognitionReport hint{.hinted = {cam(0)}};
  const Requests requests = run(hint);
  ASSERT_TRUE(requests.contains(cam(0)));
  EXPECT_EQ(requests.at(cam(0)), DescriptorRequest::kEverywhere);
}

TEST_F(DescriptorRequestsTest, ACameraWithoutAMapDescribesAllItSees) {
  sim_.edit.leave_map(sim_.map.camera(cam(1)));
  step();
  const Requests requests = run();
  ASSERT_TRUE(requests.contains(cam(1)));
  EXPECT_EQ(requests.at(cam(1)), DescriptorRequest::kEverywhere);
}

}  // namespace
}  // namespace coslam::descriptor_requests_test
