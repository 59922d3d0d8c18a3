// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/dataset/result_folder.h"
#include "deploy/coslam/export/result_timeline.h"
#include "server/show/publish/snapshot.h"

namespace coslam::exporting {

// A run that is over, told as it would have been told live, but with what is known in the end: final poses, points from
// the instant at which they were first seen. Not thread-safe.
class ResultSnapshots {
 public:
  // Reads the whole result. Throws UserError.
  explicit ResultSnapshots(const ResultContents& contents) : timeline_(timeline_of(contents)) {}

  // Next snapshot in order of time; empty at the end.
  std::optional<Snapshot> next();

 private:
  using Agent = ResultTimeline::Agent;
  // State of an agent at the instant that was told last.
  struct Told {
    std::optional<PublicPose> newest;
    std::uint32_t frames = 0;
    std::size_t tracks = 0, bound = 0;
  };

  std::shared_ptr<const PublicMoving> moving_at(TimeNs t_ns);
  std::shared_ptr<const PublicCloud> cloud_at(TimeNs t_ns);
  std::shared_ptr<const PublicPaths> paths_at(TimeNs t_ns);
  std::shared_ptr<const PublicTracks> tracks_until(TimeNs t_ns);
  std::shared_ptr<const PublicState> state_at(TimeNs t_ns);
  PublicAgent agent_at(const Agent& agent, const Told& told, TimeNs t_ns) const;
  std::optional<std::string> why_lost(const Agent& agent, TimeNs t_ns) const;
  bool due(std::optional<TimeNs>* last, TimeNs t_ns, double period_s) const;

  ResultTimeline timeline_;           // moving points and tracks that were told are no longer in it
  std::map<std::string, Told> told_;  // state of each agent
  std::size_t next_ = 0, next_event_ = 0;
  bool moves_ = false;  // whether the last snapshot had something moving
  std::size_t told_points_ = 0;
  std::optional<TimeNs> cloud_ns_, paths_ns_, state_ns_;
};

}  // namespace coslam::exporting
