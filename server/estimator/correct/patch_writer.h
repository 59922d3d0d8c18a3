// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "common/model/map_patch.h"
#include "server/estimator/associate/patch_worth.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/pipeline/stage.h"

namespace coslam {

struct CorrectConfig {
  double moved_px = 0.3;                 // a point is sent again when it moved so far in this camera's image
  double covariance_ratio = 2.0;         // or its covariance changed by this factor
  double patch_period_s = 0.1;           // between requests for image patches: together they share a datagram
  int patches_per_request = 16;          // of tracks that move and of others each, at most
  double patch_refresh_s = 2.0;          // and again after so long while it has no point
  double moving_patch_refresh_s = 0.33;  // or while it moves
  double patch_patience_s = 1.0;         // an answer may take so long before it is asked for again
};

template <class V>
void describe(V& v, CorrectConfig& c) {
  v.field("moved_px", c.moved_px, {0, 100}, "a point is sent again when it moved so far in the agent's image");
  v.field("covariance_ratio", c.covariance_ratio, {1, 1000}, "or its covariance changed by this factor");
  v.field("patch_period_s", c.patch_period_s, {0.01, 100}, "between requests for image patches");
  v.field("patches_per_request", c.patches_per_request, {0, 1000},
          "image patches asked for at once, at most, of tracks that move and of others each");
  v.field("patch_refresh_s", c.patch_refresh_s, {0.01, 1000}, "after which an unmapped track is asked again");
  v.field("moving_patch_refresh_s", c.moving_patch_refresh_s, {0.01, 1000}, "the same for tracks that move");
}

// Tells one agent what changed for it: keeps what it was told, and writes the difference.
class PatchWriter {
 public:
  PatchWriter(const ServerRun& server, const CorrectConfig& config) : server_(server), config_(config) {}

  // After a frame set that held `frame` of `camera`. How the camera's world moved is told with it.
  MapPatch begin(CorrectEdit& edit, const MapCamera& camera, const TrackFrame& frame, DescriptorRequest descriptors);
  // Then what it is told of points and asked for. Only reads the map, and takes most of the time.
  // worths: where few image patches get through, which of them are asked for.
  void fill(const Map& map, const MapCamera& camera, const TrackFrame& frame, const PatchWorths* worths,
            MapPatch* patch);
  // After a frame that came too late to be used: its agent only learns that it may go on.
  MapPatch acknowledge(const Map& map, const MapCamera& camera, const TrackFrame& frame);

 private:
  void write_lens(const MapCamera& camera, MapPatch* patch);
  MapPatch next_patch(const Map& map, const MapCamera& camera, const TrackFrame& frame);

  struct Sent {
    PointId point;
    PointState state = PointState::kUncertain;  // as told
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    double trace = 0;
  };
  struct News {
    double need = 0;  // how much the agent misses it
    Sent now;
    BoundPoint told_as;
  };
  std::optional<double> need_of(const Sent* told, const Sent& now, const MapCamera& camera) const;
  void consider(TrackId track, const Sent& now, const Eigen::Matrix3d& covariance, const MapCamera& camera,
                std::vector<News>& news) const;
  void write_bindings(const Map& map, const MapCamera& camera, bool narrow_link, MapPatch* patch);
  // Tracks whose image patches are due, best first: what tells most, then those never cut, then the stalest.
  struct PatchesDue {
    using Rank = std::tuple<PatchWorths::Rank, std::uint32_t, TrackId>;
    std::vector<Rank> still, moving, alone;
    std::size_t unanswered = 0;  // tracks whose patch was asked for and has not come
  };
  PatchesDue patches_due(const Map& map, const MapCamera& camera, const PatchWorths* worths) const;
  void write_requests(const Map& map, const MapCamera& camera, const PatchWorths* worths, MapPatch* patch);

  ServerRun server_;
  CorrectConfig config_;
  RunId agent_run_;
  std::uint32_t sequence_ = 0;
  MapEpoch epoch_;
  MapId map_;
  LensCorrection lens_;  // as told
  std::map<TrackId, Sent> sent_;
  std::map<TrackId, SetId> asked_;  // for patches, lately
};

}  // namespace coslam
