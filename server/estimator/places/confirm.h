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
#include "server/estimator/reports/place_recognition_report.h"

namespace coslam {

// Keeps what one image said about the relative pose of two maps, or of two parts of one, until it is confirmed. Before
// anything moves another image of another instant has to agree, and both together have to see more than one plane,
// because two rooms may have the same poster. Exempt from the second condition are places near where they were expected
// anyway, and ground that covers more than any print, unless something says that it repeats itself.
class Verification {
 public:
  // Adds an image as evidence. kNone once, when the place is confirmed. in_from_own: transform from the camera's map as
  // it is now to the recognised place's, which says where its part belongs. enough: the image has enough points to
  // confirm; one of the two has to.
  PlaceDoubt examine(const Map& map, const DescribedImage& image, const PlaceMatch& seen,
                     const Similarity3& in_from_own, const ViewGraph& graph, bool enough);
  // Type of evidence that a camera could add to a hypothesis: more of the same flat ground, in another view; a second
  // image of an expected place; a second image of a place that was not expected there.
  enum class Waiting : std::uint8_t { kNothing, kMore, kExpected, kAnywhere };
  Waiting waiting(const Map& map, CameraId camera) const;
  // Drops hypotheses within a map, after a loop of it was closed; and all of two maps, after they were joined.
  void drawn_together(MapId map);
  void joined(MapId one, MapId other);

 private:
  // Part of a map whose cameras move together: a whole map; within one map, the group of cameras with this first one,
  // or, without one, the map's past.
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
    SetId first, newest;  // first and newest set that said so
    bool expected = false, enough = false;
    bool many = false;    // the newest image alone has many points
    double depth = 0;     // largest median depth of the images
    bool relief = false;  // one image by itself is not flat
    bool flat = false;    // all points so far lie on a plane
    std::set<PointId> evidence;
    std::set<CameraId> cameras;  // cameras that saw the place or were seen by it
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
