// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/correct/patch_writer.h"

#include <algorithm>

namespace coslam {

namespace {

// Agents localise on static points: what is not proven is uncertain to them.
PointState state_for(const MapCamera& camera, const MapPoint& p) {
  return p.phase == PointPhase::kTrial && !camera.sparse ? PointState::kUncertain : told_state(p.phase);
}

}  // namespace

bool PatchWriter::worth_telling(const Told& told, const MapPoint& p, const MapCamera& camera) const {
  if (told.point != p.id || told.state != state_for(camera, p)) return true;
  const double trace = p.covariance.trace();
  if (trace > told.trace * config_.covariance_ratio || trace * config_.covariance_ratio < told.trace) return true;
  const FramePose& f = camera.frames.back();
  const double distance = f.valid() ? (p.position - f.cam_from_world.center()).norm() : 1.0;
  return (p.position - told.position).norm() * camera.model.focal_px() > config_.moved_px * distance;
}

void PatchWriter::write_bindings(const Map& map, const MapCamera& camera, bool snapshot, MapPatch* patch) {
  if (snapshot) told_.clear();
  for (auto at = told_.begin(); at != told_.end();) {
    const auto track = camera.tracks.find(at->first);
    const bool ended = track == camera.tracks.end();
    const bool free = !ended && !track->second.bound();
    if (free) patch->unbound.push_back(at->first);
    at = ended || free ? told_.erase(at) : std::next(at);
  }
  for (const auto& [id, track] : camera.tracks) {
    const MapPoint* p = map.find(track.point);
    if (p == nullptr) continue;
    const auto told = told_.find(id);
    if (told != told_.end() && !worth_telling(told->second, *p, camera)) continue;
    const PointState state = state_for(camera, *p);
    told_[id] = {p->id, state, p->position, p->covariance.trace()};
    patch->updated.push_back({id, p->id, state, p->position.cast<float>(), pack_covariance(p->covariance)});
  }
}

void PatchWriter::write_requests(const Map& map, const MapCamera& camera, MapPatch* patch) const {
  if (patch->sequence % static_cast<std::uint32_t>(camera.frames_in(config_.patch_period_s)) != 0) return;
  using Due = std::vector<std::pair<std::uint32_t, TrackId>>;  // those never cut first, then the stalest
  Due still, moving;
  for (const auto& [id, t] : camera.tracks) {
    if (static_cast<int>(t.seen.size()) < camera.frames_in(config_.patch_track_s, 2)) continue;
    const std::uint32_t refresh = map.sets_in(t.moves() ? config_.moving_patch_refresh_s : config_.patch_refresh_s);
    const bool keeps = t.bound() && !t.moves();
    if (t.patch && (keeps || t.patch_set.value + refresh > map.now().value)) continue;
    (t.moves() ? moving : still).emplace_back(t.patch ? t.patch_set.value + 1 : 0, id);
  }
  // What moves soon looks different or is gone: it doesn't wait behind what stays.
  for (Due* due : {&moving, &still}) {
    const auto most = std::min(due->size(), static_cast<std::size_t>(config_.patches_per_request));
    std::partial_sort(due->begin(), due->begin() + static_cast<std::ptrdiff_t>(most), due->end());
    for (std::size_t i = 0; i < most; ++i) patch->patch_requests.push_back((*due)[i].second);
  }
  std::sort(patch->patch_requests.begin(), patch->patch_requests.end());
}

MapPatch PatchWriter::next_patch(const Map& map, const MapCamera& camera, const TrackFrame& frame) {
  if (frame.agent_run != agent_run_) {
    agent_run_ = frame.agent_run;
    sequence_ = 0;
    told_.clear();
    epoch_ = map.epoch();
  }
  MapPatch patch;
  patch.agent = camera.name;
  patch.server_run = server_run_;
  patch.agent_run = agent_run_;
  patch.sequence = ++sequence_;
  patch.after_frame = frame.frame;
  patch.epoch = map.epoch();
  return patch;
}

MapPatch PatchWriter::acknowledge(const Map& map, const MapCamera& camera, const TrackFrame& frame) {
  MapPatch patch = next_patch(map, camera, frame);
  patch.snapshot = true;
  told_.clear();
  map_ = MapId();
  return patch;
}

MapPatch PatchWriter::write(MapEdit& edit, const MapCamera& camera, const TrackFrame& frame,
                            DescriptorRequest descriptors) {
  const Map& map = edit.map();
  MapPatch patch = next_patch(map, camera, frame);
  // What was merged into another map is still known, only elsewhere.
  const bool other_map = camera.map != map_ && (map_ == MapId() || camera.merged_from != map_);
  const bool snapshot = patch.sequence == 1 || frame.wants_snapshot || other_map;
  patch.snapshot = snapshot;
  if (epoch_ != map.epoch() && !other_map) {
    patch.new_from_old = camera.moved;
    const double s = camera.moved.scale;
    for (auto& [id, t] : told_) {
      t.position = camera.moved * t.position;
      t.trace *= s * s;
    }
  }
  edit.agent_was_told(camera);
  epoch_ = map.epoch();
  map_ = camera.map;

  const FramePose& f = camera.frames.back();
  // The agent cannot know where it is: it was just placed, or lost its way, or missed how the map moved.
  const bool knows = frame.pose_state == PoseState::kTracked && !snapshot;
  if (f.valid() && (!knows || camera.corrected)) patch.placed = PlacedPose{f.frame, f.cam_from_world};
  write_bindings(map, camera, snapshot, &patch);
  write_requests(map, camera, &patch);
  patch.descriptor_request = descriptors;
  return patch;
}

}  // namespace coslam
