// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "server/estimator/map/journal.h"
#include "server/estimator/map/map.h"
#include "tests/support/same_fields.h"

namespace coslam::test {

// What it noted so far is of a set that is over.
inline void forget(Journal& journal) {
  journal.end_set();
  journal.begin_set();
}

// Every bit of the state that the next step stands on.
inline void expect_same(const Map& a, const Map& b) { ASSERT_EQ(Difference().of(a, b), ""); }

inline auto key_of(const KeyObservation& o) { return std::tie(o.set, o.camera, o.track); }

inline bool sorted_and_unique(const std::vector<KeyObservation>& all) {
  const auto not_ascending = [](const auto& a, const auto& b) { return key_of(a) >= key_of(b); };
  return std::adjacent_find(all.begin(), all.end(), not_ascending) == all.end();
}

inline bool observed(const MapPoint& p, SetId set, CameraId camera, TrackId track) {
  return std::any_of(p.key_observations.begin(), p.key_observations.end(),
                     [&](const KeyObservation& o) { return o.set == set && o.camera == camera && o.track == track; });
}

// Points by a scan over all of them, ascending.
template <class Wanted>
std::vector<const MapPoint*> scan(const Map& map, Wanted wanted) {
  std::vector<const MapPoint*> out;
  for (const auto& [id, p] : map.points()) {
    if (wanted(p)) out.push_back(&p);
  }
  return out;
}

// Bindings are told twice, by the track and by the point, and what moves by the point and by the map; they must agree.
inline void expect_consistent(const Map& map) {
  EXPECT_EQ(map.moving_points(), scan(map, [](const MapPoint& p) { return p.moves(); }));
  for (const auto& [id, p] : map.points()) {
    EXPECT_EQ(id, p.id);
    EXPECT_EQ(map.find(id), &p);
    EXPECT_TRUE(sorted_and_unique(p.key_observations)) << id.value;
    for (const KeyObservation& o : p.key_observations) EXPECT_TRUE(map.keeps_observations_of(o.set, o.camera));
    for (const BoundTrack& b : p.bound) {
      const auto at = map.camera(b.camera).tracks.find(b.track);
      ASSERT_NE(at, map.camera(b.camera).tracks.end());
      EXPECT_EQ(at->second.point, id);
    }
  }
  for (const MapCamera& c : map.cameras()) {
    for (const auto& [id, t] : c.tracks) {
      EXPECT_EQ(id, t.id);
      if (!t.bound()) continue;
      const MapPoint* p = map.find(t.point);
      ASSERT_NE(p, nullptr);
      EXPECT_EQ(std::count(p->bound.begin(), p->bound.end(), BoundTrack{c.id, id}), 1);
    }
  }
}

}  // namespace coslam::test
