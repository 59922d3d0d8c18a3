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
  double moved_px = 0.3;          // change of a point's position in this camera's image after which it is sent again
  double covariance_ratio = 2.0;  // factor of change of a point's covariance after which it is sent again
  double patch_period_s = 0.1;    // time between requests for image patches: together they share a datagram
  int patches_per_request = 16;   // most requests at once, of tracks that move and of others each
  double patch_refresh_s = 2.0;   // time after which a patch of a track without a point is requested again
  double moving_patch_refresh_s = 0.33;  // time after which a patch of a track that moves is requested again
  double patch_patience_s = 1.0;         // time that an answer may take before the patch is requested again
};

template <class V>
void describe(V& v, CorrectConfig& c) {
  v.field("moved_px", c.moved_px, {0, 100}, "a point is sent again when it moved so far in the agent's image");
  v.field("covariance_ratio", c.covariance_ratio, {1, 1000}, "or its covariance changed by this factor");
  v.field("patch_period_s", c.patch_period_s, {0.01, 100}, "between requests for image patches");
  v.field("patches_per_request", c.patches_per_request, {0, 1000},
          "image patches asked for at once, at most, of tracks that move and of others each");
  v.field("patch_refresh_s", c.patch_refresh_s, {0.01, 1000}, "after which an unmapped track is asked again");
}

// Writes the map patches of one agent: keeps what was sent, and writes the difference.
class PatchWriter {
 public:
  PatchWriter(const ServerRun& server, const CorrectConfig& config) : server_(server), config_(config) {}

  // Begins the patch after a frame set that held `frame` of `camera`: how the camera's world moved, and which
  // descriptors are asked for.
  MapPatch begin(CorrectEdit& edit, const MapCamera& camera, const TrackFrame& frame, DescriptorRequest descriptors);
  // Completes the patch with points and requests for image patches. Only reads the map, and takes most of the time.
  // worths: decide which image patches are requested where few get through; null: all may be.
  void fill(const Map& map, const MapCamera& camera, const TrackFrame& frame, const PatchWorths* worths,
            MapPatch* patch);
  // Answers a frame that came too late to be used with an empty snapshot: its agent may go on.
  MapPatch acknowledge(const Map& map, const MapCamera& camera, const TrackFrame& frame);

 private:
  void write_lens(const CameraLens& camera, MapPatch* patch);
  MapPatch next_patch(const Map& map, const CameraIdentity& camera, const TrackFrame& frame);

  struct Sent {
    PointId point;
    PointState state = PointState::kUncertain;  // state as sent
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    double trace = 0;
  };
  struct News {
    double need = 0;  // priority: how much the agent lacks it
    Sent now;
    BoundPoint told_as;
  };
  std::optional<double> need_of(const Sent* sent, const Sent& now, const MapCamera& camera) const;
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
  LensCorrection lens_;  // lens correction as sent
  std::map<TrackId, Sent> sent_;
  std::map<TrackId, SetId> asked_;  // set at which a patch was requested last
};

}  // namespace coslam
