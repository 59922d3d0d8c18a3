// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/dataset/result.h"
#include "common/dataset/trajectory.h"
#include "server/show/publish/snapshot.h"

namespace coslam::exporting {

// A run that is over, told as it would have been told live, but with what is known in the end: final poses, points from
// the instant at which they were first seen. Not thread-safe.
class ResultSnapshots {
 public:
  // Reads the whole result. Throws UserError.
  explicit ResultSnapshots(const ResultContents& contents);

  // Next snapshot in order of time; empty at the end.
  std::optional<Snapshot> next();

 private:
  struct Instant {
    TimeNs t_ns = 0;
    std::vector<PublicPose> poses;
  };
  struct Agent {
    std::string name;
    RunId run;
    CameraModel camera;
    double frame_ms = 0, rate_hz = 0;
    std::vector<std::pair<MapId, Trajectory>> paths;  // path in each map that it has poses in
    std::optional<PublicPose> newest;
    TimeNs last_ns = 0;  // time of its last pose
    std::uint32_t frames = 0;
    std::size_t tracks = 0, bound = 0;
    std::optional<PathVerdict> path;  // in the end
  };

  void read_report(const ResultFolder& result);
  void read_map(const ResultMap& map);
  void read_moving(const ResultMap& map);
  void read_tracks(const ResultFolder& result);
  void gather_instants();
  Agent* find(const std::string& name);

  std::shared_ptr<const PublicMoving> moving_at(TimeNs t_ns);
  std::shared_ptr<const PublicCloud> cloud_at(TimeNs t_ns);
  std::shared_ptr<const PublicPaths> paths_at(TimeNs t_ns);
  std::shared_ptr<const PublicTracks> tracks_until(TimeNs t_ns);
  std::shared_ptr<const PublicState> state_at(TimeNs t_ns);
  PublicAgent agent_at(const Agent& agent, TimeNs t_ns) const;
  std::optional<std::string> why_lost(const Agent& agent, TimeNs t_ns) const;
  bool due(std::optional<TimeNs>* last, TimeNs t_ns, double period_s) const;

  MapId main_;
  bool scale_known_ = false;
  double ms_per_set_ = 0;
  std::vector<Agent> agents_;
  std::vector<Instant> instants_;
  std::size_t next_ = 0;
  std::vector<std::pair<TimeNs, ros::StaticPoint>> points_;  // points and the times when they were first seen
  std::map<TimeNs, PublicMoving> moving_;
  std::map<TimeNs, std::vector<PublicImage>> images_;
  std::vector<PublicEvent> events_;
  std::size_t next_event_ = 0;
  std::vector<ResultGroupRow> groups_;
  std::size_t maps_ = 0;

  bool moves_ = false;  // whether the last snapshot had something moving
  std::size_t told_points_ = 0;
  std::optional<TimeNs> cloud_ns_, paths_ns_, state_ns_;
};

}  // namespace coslam::exporting
