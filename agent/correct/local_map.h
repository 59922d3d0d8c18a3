// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "common/base/ids.h"
#include "common/geometry/rigid3.h"
#include "common/model/map_patch.h"
#include "common/model/track_frame.h"

namespace coslam {

// Effect of a patch on the agent's own pose.
struct PatchEffect {
  bool accepted = false;
  bool new_server = false;             // the patch is of another server run
  bool goes_on = false;                // with the map of the one before; otherwise every earlier pose is meaningless
  std::optional<Similarity3> rebase;   // the map moved: re-express poses
  std::optional<LensCorrection> lens;  // new correction of the agent's lens
  std::optional<PlacedPose> placed;    // the server says where this agent was at a frame
  std::vector<TrackId> patch_requests;
  DescriptorRequest descriptor_request = DescriptorRequest::kNone;
};

// The agent's part of the map: the points bound to its live tracks. The server owns them; the agent only follows its
// patches, in order. A gap in their sequence is answered by asking for a snapshot.
class LocalMap {
 public:
  explicit LocalMap(RunId agent_run) : agent_run_(agent_run) {}

  PatchEffect apply(const MapPatch& patch);
  // Forgets the bindings of tracks that ended. `tracks` ascending.
  void keep_only(const std::vector<TrackObservation>& tracks);
  void clear();

  struct Entry {
    PointId point;
    PointState state = PointState::kStatic;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    bool former = false;  // binding of the server before, whose map goes on: this server has not confirmed it yet, and
                          // may not have it
    // A far_point(): the track has no point.
    bool is_direction() const { return point == PointId() && state == PointState::kUncertain; }
  };
  const Entry* find(TrackId track) const;
  std::size_t size() const { return entries_.size(); }

  RunId server_run() const { return server_run_; }
  MapEpoch epoch() const { return epoch_; }
  std::uint32_t applied_sequence() const { return applied_; }
  bool wants_snapshot() const { return wants_snapshot_; }

 private:
  void change_server(const MapPatch& patch, PatchEffect* effect);
  struct Move {
    MapEpoch to;
    Similarity3 new_from_old;
  };

  void move_all(const Similarity3& new_from_old);
  void restart_at(MapEpoch epoch);
  void note_epoch(const MapPatch& patch);
  std::optional<Similarity3> moved_since(MapEpoch epoch) const;

  RunId agent_run_;
  RunId server_run_;
  MapEpoch epoch_;
  std::uint32_t applied_ = 0;
  bool wants_snapshot_ = false;
  std::map<TrackId, Entry> entries_;
  std::deque<Move> moves_;  // how the map moved to each epoch; epochs before the first are not known
};

}  // namespace coslam
