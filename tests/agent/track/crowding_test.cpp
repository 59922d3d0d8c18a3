// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/crowding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace coslam::crowding_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<Track> tracks_at(const std::vector<Eigen::Vector2f>& places_px) {
  std::vector<Track> tracks;
  for (const Eigen::Vector2f& px : places_px) tracks.push_back({TrackId(tracks.size() + 1), px, 0});
  return tracks;
}

TEST(Crowding, TheNewestGoFromWhereTracksStandClosest) {
  const std::vector<Track> tracks = tracks_at({{10, 10}, {300, 200}, {12, 10}, {305, 202}, {14, 12}, {600, 400}});
  EXPECT_THAT(crowded_tracks(tracks, 640, 480, 1), ElementsAre(4));
  // Three places are left with one track each.
  EXPECT_THAT(crowded_tracks(tracks, 640, 480, 3), ElementsAre(4, 3, 2));
}

TEST(Crowding, TracksBesideTheImageCountWithItsRim) {
  EXPECT_THAT(crowded_tracks(tracks_at({{10, 10}, {300, 200}, {-5, -5}}), 640, 480, 1), ElementsAre(2));
}

TEST(Crowding, NoneGoesWhereNoneIsAskedFor) {
  const std::vector<Track> tracks = tracks_at({{10, 10}, {300, 200}});
  EXPECT_THAT(crowded_tracks(tracks, 640, 480, 0), IsEmpty());
  EXPECT_THAT(crowded_tracks(tracks, 640, 480, -3), IsEmpty());
}

}  // namespace
}  // namespace coslam::crowding_test
