// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/estimator/covisibility/grouping.h"
#include "server/estimator/map/map.h"
#include "server/estimator/places/key_image_database.h"

namespace coslam {

// What one image said of how two maps, or two parts of one, lie to each other. Before anything moves another image of
// another instant has to say the same, and both together have to see more than one plane: two rooms may have the same
// poster. Not so a place near where it was expected anyway, nor ground that covers more than any print, where nothing
// says that it repeats itself.
class Verification {
 public:
  // in_from_own: from the camera's map as it is now to the recognised place's, by which its part belongs elsewhere.
  // enough: in so many points that it may confirm; one of the two has to. True once, when it is confirmed.
  bool confirmed(const Map& map, const DescribedImage& image, const PlaceMatch& seen, const Similarity3& in_from_own,
                 const ViewGraph& graph, bool enough);
  // Whether the camera saw, or was seen by, what waits to be confirmed: by more of the same ground, which another view
  // has to show; by a second image; by one of what was not expected there.
  enum class Waiting : std::uint8_t { kNothing, kMore, kExpected, kAnywhere };
  Waiting waiting(const Map& map, CameraId camera) const;
  // A map was drawn together: nothing that lies in it waits any more. Two were joined: nor what others say of them.
  void drawn_together(MapId map);
  void joined(MapId one, MapId other);

 private:
  // All cameras of a map; or of one map those of the group with this first camera; or its past.
  struct Part {
    MapId map;
    std::optional<CameraId> first;
    friend auto operator<=>(const Part&, const Part&) = default;
  };
  struct Hypothesis {
    Part first, second;  // first < second
    friend auto operator<=>(const Hypothesis&, const Hypothesis&) = default;
  };
  struct Pending {
    Similarity3 second_from_first;
    SetId first, since;  // said for the first time, and lastly
    bool expected = false, enough = false;
    bool many = false;    // points, in the newest image alone
    double depth = 0;     // the largest of the images
    bool relief = false;  // of an image by itself
    bool flat = false;    // all that was seen so far
    std::set<PointId> evidence;
    std::set<CameraId> cameras;  // that saw it or were seen
  };
  void repeats(const Map& map, MapId id);
  bool flat_is_enough(const Map& map, const Hypothesis& hypothesis, const std::vector<const MapPoint*>& evidence,
                      double farthest_depth) const;
  static std::pair<Part, Part> parts(const Map& map, const MapCamera& camera, const PlaceMatch& seen,
                                     const ViewGraph& graph);

  std::map<Hypothesis, Pending> pending_;
  std::map<MapId, SetId> repeating_;  // maps in which one flat thing was recognised in two places, and when last
};

}  // namespace coslam
