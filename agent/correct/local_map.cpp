// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/correct/local_map.h"

#include <algorithm>

namespace coslam {

PatchEffect LocalMap::apply(const MapPatch& patch) {
  PatchEffect effect;
  if (patch.agent_run != agent_run_) return effect;
  if (patch.server_run != server_run_) {
    // A server that restarted numbers its patches from 1; joining in the middle of its life takes a snapshot.
    clear();
    server_run_ = patch.server_run;
    effect.new_server = true;
  }
  if (patch.sequence <= applied_) return effect;
  const bool gap = patch.sequence != applied_ + 1;
  if (gap && !patch.snapshot) {
    wants_snapshot_ = true;
    return effect;
  }
  applied_ = patch.sequence;
  wants_snapshot_ = false;
  effect.accepted = true;

  if (patch.epoch != epoch_) {
    // Across a gap the similarity of this patch alone does not lead here; the placed pose of a snapshot does.
    if (!gap) {
      move_all(patch.new_from_old);
      effect.rebase = patch.new_from_old;
    }
    epoch_ = patch.epoch;
  }
  if (patch.snapshot) entries_.clear();
  for (const TrackId track : patch.unbound) entries_.erase(track);
  for (const BoundPoint& b : patch.updated) {
    entries_[b.track] = {b.point, b.state, b.position.cast<double>(), unpack_covariance(b.covariance)};
  }
  effect.placed = patch.placed;
  effect.patch_requests = patch.patch_requests;
  effect.descriptor_request = patch.descriptor_request;
  return effect;
}

void LocalMap::keep_only(const std::vector<TrackObservation>& tracks) {
  std::erase_if(entries_, [&](const auto& entry) {
    const auto at = std::lower_bound(tracks.begin(), tracks.end(), entry.first,
                                     [](const TrackObservation& o, TrackId id) { return o.track < id; });
    return at == tracks.end() || at->track != entry.first;
  });
}

void LocalMap::clear() {
  entries_.clear();
  applied_ = 0;
  epoch_ = MapEpoch{};
  wants_snapshot_ = false;
}

const LocalMap::Entry* LocalMap::find(TrackId track) const {
  const auto at = entries_.find(track);
  return at == entries_.end() ? nullptr : &at->second;
}

void LocalMap::move_all(const Similarity3& new_from_old) {
  const Eigen::Matrix3d m = new_from_old.scale * new_from_old.rotation.toRotationMatrix();
  for (auto& [track, e] : entries_) {
    e.position = new_from_old * e.position;
    e.covariance = m * e.covariance * m.transpose();
  }
}

}  // namespace coslam
