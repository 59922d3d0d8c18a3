// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "server/estimator/map/map.h"
#include "server/estimator/map/rows.h"
#include "server/estimator/motion/followed_paths.h"
#include "server/estimator/motion/moving_path.h"
#include "server/estimator/reports/objects_report.h"
#include "server/estimator/reports/scale_report.h"

namespace coslam {

// Lengths are in units of the reach: how far apart two neighbouring points of one body may be.
struct ObjectsConfig {
  double reach_m = 0.8;       // reach where the scale is known
  double reach_share = 0.16;  // reach where it is not, as a share of the distance from the cameras
  double path_s = 1.0;  // newest part of the points' paths that is compared and gives the velocity; an object out of
                        // sight for longer is forgotten
  double min_path_s = 0.2;  // shorter paths wait
  double max_sigma = 0.4;   // sqrt(trace Sigma); points with more wait
  double stretch = 0.25;    // largest change of the distance of two points of one body
  double shift = 0.6;       // largest shift of parts of one body against each other over their path
  double speed_gate = 1.2;  // per second: largest difference of an object from what it was before it was out of sight
  double min_speed = 0.2;   // per second: slower new objects are not taken up, known ones are kept
  int min_points = 3;       // least points of a new object; a known one is kept with two
};

template <class V>
void describe(V& v, ObjectsConfig& c) {
  v.field("reach_m", c.reach_m, {0.01, 1000}, "between neighbouring points of a body, when the scale is known");
  v.field("reach_share", c.reach_share, {0.001, 1}, "the same when it is not, of the distance from the cameras");
  v.field("path_s", c.path_s, {0.2, 10}, "newest part of the paths that is compared and gives the velocity");
  v.field("min_speed", c.min_speed, {0, 100}, "of the reach a second, of a new object");
  v.field("min_points", c.min_points, {2, 1000}, "of a new object");
}

// Moving point as candidate for an object.
struct MovingPoint {
  PointId id;
  MapId map;
  MovingPath path;  // newest path_s
  double sigma = 0;
  double reach = 0;
};

// Groups moving points that move together, every frame set. Points are linked, nearest first, when they are near each
// other and their distance has hardly changed over their common path: so limbs hang on a body although they swing, and
// what passes by does not. Parts of several points are joined only when they go the same way. An object keeps its id by
// its members, and when all of them were replaced, by its predicted position.
class Objects {
 public:
  static constexpr std::string_view kName = "objects";
  using Config = ObjectsConfig;
  explicit Objects(const ObjectsConfig& stage_config) : config(stage_config) {}
  ObjectsConfig config;

  // Groups the map's moving points; scale: which maps are metric.
  ObjectsReport run(const Map& map, const FrameSet& set, const ScaleReport& scale);
  // Groups moving points that do not come from a map.
  ObjectsReport step(const std::vector<MovingPoint>& points, TimeNs now_ns);

  // Objects of the last step, sorted by id.
  const std::vector<MovingObject>& objects() const { return objects_; }
  // Keeps the number of the next new object, so that ids go on in another server.
  void save(std::vector<Row>* rows) const;
  void restore(const Tables& tables);

 private:
  struct Candidate;
  struct Part;
  struct Known {
    MapId map;
    BodyMotion motion;
    double reach = 0;
    TimeNs first_ns = 0, last_ns = 0;
  };
  struct Membership {
    ObjectId object;
    TimeNs last_ns = 0;
  };
  std::vector<Candidate> candidates(const std::vector<MovingPoint>& points, TimeNs now_ns) const;
  class Joining;
  std::vector<Part> parts(const std::vector<Candidate>& all, TimeNs now_ns) const;
  bool lasts(ObjectId object, TimeNs now_ns) const;  // has lived for longer than a path
  ObjectId object_of(PointId point) const;
  void name_by_members(std::vector<Part>& parts) const;
  void name_by_place(std::vector<Part>& parts, TimeNs now_ns) const;
  void forget(TimeNs now_ns);

  FollowedPaths paths_;
  std::map<PointId, Membership> members_;
  std::map<ObjectId, Known> known_;
  std::uint32_t next_object_ = 1;
  std::vector<MovingObject> objects_;
};

}  // namespace coslam
