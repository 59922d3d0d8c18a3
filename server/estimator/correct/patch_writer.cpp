// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/correct/patch_writer.h"

#include <algorithm>
#include <functional>
#include <tuple>
#include <vector>

#include "server/estimator/map/sighting.h"

namespace coslam {

namespace {

// Agents localise on static points: what is not proven is uncertain to them.
PointState state_for(const CameraLocalisation& camera, const MapPoint& p) {
  return p.phase == PointPhase::kTrial && !camera.sparse ? PointState::kUncertain : told_state(p.phase);
}

// So few that the agent needs directions too.
bool few_points(const Map& map, const MapCamera& camera) {
  return std::ranges::count_if(camera.tracks, [&](const auto& t) {
           const MapPoint* p = map.find(t.second.point);
           return p != nullptr && state_for(camera, *p) == PointState::kStatic;
         }) < map.config().few_points;
}

}  // namespace

// Nothing when it knows. Above all it must not rest on what is none any more, then it needs what it has nothing for;
// a pixel moved counts as a covariance twice or half as large.
std::optional<double> PatchWriter::need_of(const Sent* sent, const Sent& now, const MapCamera& camera) const {
  constexpr double kWrong = 1e12, kNew = 1e9;
  const bool is_static = now.state == PointState::kStatic;
  if (sent == nullptr) return is_static ? kNew : 0.0;
  if (sent->point != now.point || sent->state != now.state) return sent->state == PointState::kStatic ? kWrong : kNew;
  if (!is_static && now.point != PointId()) return std::nullopt;  // its place is not told
  const FramePose& f = camera.frames.back();
  const double distance = f.valid() ? (now.position - f.cam_from_world.center()).norm() : 1.0;
  const double moved_px = (now.position - sent->position).norm() * camera.model.focal_px() / distance;
  const double ratio = std::max(now.trace / sent->trace, sent->trace / now.trace);
  if (moved_px <= config_.moved_px && ratio <= config_.covariance_ratio) return std::nullopt;
  return std::max(moved_px, ratio - 1);
}

void PatchWriter::consider(TrackId track, const Sent& now, const Eigen::Matrix3d& covariance, const MapCamera& camera,
                           std::vector<News>& news) const {
  const auto sent = sent_.find(track);
  const auto need = need_of(sent == sent_.end() ? nullptr : &sent->second, now, camera);
  if (!need) return;
  news.push_back({*need, now, {track, now.point, now.state, now.position.cast<float>(), pack_covariance(covariance)}});
}

namespace {

// A patch of several datagrams is not for a narrow link: with each of them the middleware says what there is, so its
// reader asks again for those that still wait in the link's queue, and gets them many times. What finds no room is told
// with a later patch.
template <class News>
void keep_one_datagram(std::vector<News>& news) {
  constexpr std::size_t kMostBytes = 700, kPlaceBytes = 30, kOtherBytes = 6;  // beside the rest of a patch
  std::ranges::stable_sort(news, std::greater(), &News::need);
  std::size_t bytes = 0;
  const auto first_left = std::ranges::find_if(
      news, [&](const News& n) { return (bytes += n.told_as.has_place() ? kPlaceBytes : kOtherBytes) > kMostBytes; });
  news.erase(first_left, news.end());
  std::ranges::sort(news, {}, [](const News& n) { return n.told_as.track; });
}

}  // namespace

void PatchWriter::write_bindings(const Map& map, const MapCamera& camera, bool narrow_link, MapPatch* patch) {
  const bool poor = few_points(map, camera);
  std::vector<TrackId> known;  // ascending
  std::vector<News> news;
  for (const auto& [id, track] : camera.tracks) {
    if (const MapPoint* p = map.find(track.point)) {
      known.push_back(id);
      consider(id, {p->id, state_for(camera, *p), p->position, p->covariance.trace()}, p->covariance, camera, news);
      continue;
    }
    // Its agent takes what it was told once for as long as the track lives: later only what is far better.
    const auto far = poor ? far_point_of(map, camera, track) : std::nullopt;
    if (!far) continue;
    known.push_back(id);
    const auto sent = sent_.find(id);
    const Sent now{PointId(), PointState::kUncertain, far->position, far->covariance.trace()};
    if (sent != sent_.end() && sent->second.point == PointId() &&
        now.trace * config_.covariance_ratio > sent->second.trace)
      continue;
    consider(id, now, far->covariance, camera, news);
  }
  if (narrow_link) keep_one_datagram(news);
  for (const News& n : news) {
    sent_[n.told_as.track] = n.now;
    patch->updated.push_back(n.told_as);
  }
  std::erase_if(sent_, [&](const auto& entry) {
    if (std::ranges::binary_search(known, entry.first)) return false;
    if (camera.tracks.contains(entry.first)) patch->unbound.push_back(entry.first);
    return true;
  });
}

void PatchWriter::write_requests(const Map& map, const MapCamera& camera, const PatchWorths* worths, MapPatch* patch) {
  // Where few get through, what was asked for long ago is in the way of what is worth more by now.
  constexpr std::size_t kMostUnanswered = 32;
  const std::uint32_t patience = map.sets_in(config_.patch_patience_s);
  std::erase_if(asked_, [&](const auto& a) { return a.second.value + patience <= map.now().value; });
  if (patch->sequence % static_cast<std::uint32_t>(camera.frames_in(config_.patch_period_s)) != 0) return;
  PatchesDue due = patches_due(map, camera, worths);
  const auto ask = [&](std::vector<PatchesDue::Rank>& ranks, std::size_t most) {
    most = std::min(ranks.size(), most);
    std::partial_sort(ranks.begin(), ranks.begin() + static_cast<std::ptrdiff_t>(most), ranks.end());
    for (std::size_t i = 0; i < most; ++i) {
      const TrackId id = std::get<TrackId>(ranks[i]);
      patch->patch_requests.push_back(id);
      asked_[id] = map.now();
    }
    return most;
  };
  // What moves soon looks different or is gone: it doesn't wait behind what stays.
  const auto each = static_cast<std::size_t>(config_.patches_per_request);
  if (worths == nullptr) {
    ask(due.moving, each);
    ask(due.still, each);
  } else {
    const std::size_t room = std::min(each, kMostUnanswered - std::min(kMostUnanswered, due.unanswered));
    std::size_t left = room - ask(due.moving, room / 2);
    left -= ask(due.still, left);
    ask(due.alone, std::min<std::size_t>(left, 1));  // it may tell something when another camera comes by
  }
  std::sort(patch->patch_requests.begin(), patch->patch_requests.end());
}

PatchWriter::PatchesDue PatchWriter::patches_due(const Map& map, const MapCamera& camera,
                                                 const PatchWorths* worths) const {
  PatchesDue due;
  for (const auto& [id, t] : camera.tracks) {
    if (static_cast<int>(t.seen.size()) < camera.frames_in(kSettled_s, kLeastFrames))
      continue;  // many do not live longer
    const std::uint32_t refresh = map.sets_in(t.moves() ? config_.moving_patch_refresh_s : config_.patch_refresh_s);
    const bool keeps = t.bound() && !t.moves();
    if (t.patch && (keeps || t.patch_set.value + refresh > map.now().value)) continue;
    const auto asked = asked_.find(id);
    if (asked != asked_.end() && !(t.patch && t.patch_set >= asked->second)) {  // the answer is on its way
      ++due.unanswered;
      continue;
    }
    const auto worth = worths != nullptr ? worths->rank_of(camera.id, id) : PatchWorths::Rank();
    const bool tells = worths == nullptr || worth.first != PatchWorth::kAlone;
    (t.moves() ? due.moving
     : tells   ? due.still
               : due.alone)
        .emplace_back(worth, t.patch ? t.patch_set.value + 1 : 0, id);
  }
  return due;
}

MapPatch PatchWriter::next_patch(const Map& map, const CameraIdentity& camera, const TrackFrame& frame) {
  if (frame.agent_run != agent_run_) {
    agent_run_ = frame.agent_run;
    sequence_ = 0;
    sent_.clear();
    asked_.clear();
    epoch_ = map.epoch();
  }
  MapPatch patch;
  patch.agent = camera.name;
  patch.server_run = server_.id;
  patch.agent_run = agent_run_;
  patch.sequence = ++sequence_;
  patch.after_frame = frame.frame;
  patch.epoch = map.epoch();
  return patch;
}

void PatchWriter::write_lens(const CameraLens& camera, MapPatch* patch) {
  const bool news = patch->snapshot ? !camera.lens.none() : !(camera.lens == lens_);
  if (news) patch->lens = camera.lens;
  lens_ = camera.lens;
}

MapPatch PatchWriter::acknowledge(const Map& map, const MapCamera& camera, const TrackFrame& frame) {
  MapPatch patch = next_patch(map, camera, frame);
  patch.snapshot = true;
  write_lens(camera, &patch);
  sent_.clear();
  map_ = MapId();
  return patch;
}

namespace {
// Before this frame set, too.
bool was_in_its_map(const MapCamera& camera) {
  const std::size_t n = camera.frames.size();
  return camera.map != MapId() && n > 1 && camera.frames[n - 2].map == camera.map;
}
}  // namespace

MapPatch PatchWriter::begin(CorrectEdit& edit, const MapCamera& camera, const TrackFrame& frame,
                            DescriptorRequest descriptors) {
  const Map& map = edit.map();
  MapPatch patch = next_patch(map, camera, frame);
  // What was merged into another map is still known, only elsewhere.
  const bool other_map = camera.map != map_ && (map_ == MapId() || camera.merged_from != map_);
  const bool snapshot = patch.sequence == 1 || frame.wants_snapshot || other_map;
  patch.snapshot = snapshot;
  write_lens(camera, &patch);
  if (epoch_ != map.epoch() && !other_map) {
    patch.new_from_old = camera.moved;
    const double s = camera.moved.scale;
    for (auto& [id, t] : sent_) {
      t.position = camera.moved * t.position;
      t.trace *= s * s;
    }
  }
  // What its agent knows of the map of the server before this one holds here, moved as the map has moved since.
  if (server_.continues && frame.server_run == server_.continues->server_run && was_in_its_map(camera)) {
    patch.continues = server_.continues;
    if (patch.sequence == 1) patch.new_from_old = camera.moved;
  }
  edit.mark_announced(camera);
  epoch_ = map.epoch();
  map_ = camera.map;

  const FramePose& f = camera.frames.back();
  // The agent cannot know where it is: it was just placed, or lost its way, or missed how the map moved.
  const bool knows = frame.pose_state == PoseState::kTracked && !snapshot;
  if (f.valid() && (!knows || camera.corrected)) patch.placed = PlacedPose{f.frame, f.cam_from_world};
  if (snapshot) sent_.clear();
  patch.descriptor_request = descriptors;
  return patch;
}

void PatchWriter::fill(const Map& map, const MapCamera& camera, const TrackFrame& frame, const PatchWorths* worths,
                       MapPatch* patch) {
  write_bindings(map, camera, frame.narrow_link, patch);
  write_requests(map, camera, worths, patch);
}

}  // namespace coslam
