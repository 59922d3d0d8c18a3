// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/correct/local_map.h"

#include <algorithm>

namespace coslam {

// A server that restarted numbers its patches from 1; joining in the middle of its life takes a snapshot.
void LocalMap::change_server(const MapPatch& patch, PatchEffect* effect) {
  effect->new_server = true;
  const bool same_map = patch.sequence == 1 && patch.continues && patch.continues->server_run == server_run_;
  if (const auto moved = same_map ? moved_since(patch.continues->epoch) : std::nullopt) {
    effect->goes_on = true;
    effect->rebase = moved->inverse();
    move_all(*effect->rebase);
    for (auto& [track, entry] : entries_) entry.former = true;
    restart_at(patch.continues->epoch);
  } else {
    clear();
  }
  server_run_ = patch.server_run;
}

PatchEffect LocalMap::apply(const MapPatch& patch) {
  PatchEffect effect;
  if (patch.agent_run != agent_run_) return effect;
  if (patch.server_run != server_run_) change_server(patch, &effect);
  if (patch.sequence <= applied_) return effect;
  const bool gap = patch.sequence != applied_ + 1;
  if (gap && !patch.snapshot) {
    wants_snapshot_ = true;
    return effect;
  }
  applied_ = patch.sequence;
  wants_snapshot_ = false;
  effect.accepted = true;

  // Across a gap the similarity of this patch alone does not lead here; the placed pose of a snapshot does.
  if (patch.epoch != epoch_ && !gap) {
    move_all(patch.new_from_old);
    effect.rebase = effect.rebase ? patch.new_from_old * *effect.rebase : patch.new_from_old;
  }
  if (patch.snapshot && !effect.goes_on) {
    entries_.clear();
    moves_.clear();  // it may speak of another map
  }
  note_epoch(patch);
  for (const TrackId track : patch.unbound) entries_.erase(track);
  for (const BoundPoint& b : patch.updated) {
    entries_[b.track] = {b.point, b.state, b.position.cast<double>(), unpack_covariance(b.covariance)};
  }
  effect.lens = patch.lens;
  if (patch.snapshot && !effect.lens) effect.lens.emplace();
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
  restart_at(MapEpoch{});
}

void LocalMap::restart_at(MapEpoch epoch) {
  applied_ = 0;
  epoch_ = epoch;
  wants_snapshot_ = false;
  moves_.clear();
}

void LocalMap::note_epoch(const MapPatch& patch) {
  constexpr std::size_t kMost = 256;  // a minute of adjustments
  if (moves_.empty() || patch.epoch != epoch_) moves_.push_back({patch.epoch, patch.new_from_old});
  if (moves_.size() > kMost) moves_.pop_front();
  epoch_ = patch.epoch;
}

// From then to now.
std::optional<Similarity3> LocalMap::moved_since(MapEpoch epoch) const {
  Similarity3 now_from_then;
  for (auto m = moves_.rbegin(); m != moves_.rend(); ++m) {
    if (m->to == epoch) return now_from_then;
    now_from_then = now_from_then * m->new_from_old;
  }
  return std::nullopt;
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
