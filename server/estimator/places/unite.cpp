// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/unite.h"

#include <algorithm>

#include "server/estimator/associate/register.h"

namespace coslam {
namespace {

int frames_in(const Map& map, MapId id) {
  int n = 0;
  for (const MapCamera& c : map.cameras()) n += c.frames_in_map(id);
  return n;
}

SetId first_set_in(const Map& map, MapId id) {
  SetId first = map.now();
  for (const MapCamera& c : map.cameras()) {
    const auto frame = std::ranges::find(c.frames, id, &FramePose::map);
    if (frame != c.frames.end()) first = std::min(first, frame->set);
  }
  return first;
}

}  // namespace

void bind_matches(PlaceRecognitionEdit& edit, const DescribedImage& image,
                  const std::vector<std::pair<TrackId, PointId>>& matches) {
  const Map& map = edit.map();
  const MapCamera& camera = image.camera;
  const Figures agree{static_cast<double>(matches.size()), 0};
  for (const auto& [track_id, point_id] : matches) {
    const auto live = camera.tracks.find(track_id);
    const auto of_ended = image.points.find(track_id);
    const PointId own_id = live != camera.tracks.end()      ? live->second.point
                           : of_ended != image.points.end() ? of_ended->second
                                                            : PointId();
    const MapPoint* place_point = map.find(point_id);
    if (place_point == nullptr || own_id == point_id) continue;
    if (const MapPoint* own_point = map.find(own_id); own_point == nullptr) {
      if (live == camera.tracks.end() || seen_by(*place_point, camera.id)) continue;
      edit.bind(*place_point, camera.id, live->second, Why::kPlaceRecognised, agree);
    } else {
      if (!own_point->rests() || seen_at_once(*own_point, *place_point)) continue;
      edit.fuse(point_id, own_id, Why::kPlaceRecognised, agree);
    }
    edit.keep_recent(*place_point);
    retriangulate(edit, *place_point);
  }
}

void place(PlaceRecognitionEdit& edit, const DescribedImage& newest, const PlaceMatch& seen,
           const LocaliseConfig& config) {
  const MapCamera& camera = newest.camera;
  edit.place(camera, camera.frames.back().set, seen.map, seen.cam_from_world, Why::kPlaceRecognised,
             {static_cast<double>(seen.matches.size()), 0});
  bind_matches(edit, newest, seen.matches);
  localise_backwards(edit, camera, camera.frames.back().set, config);
  edit.raise_epoch();
}

SetId join(PlaceRecognitionEdit& edit, const DescribedImage& image, const PlaceMatch& seen,
           const Similarity3& in_from_own) {
  const Map& map = edit.map();
  const MapId own_map = image.camera.map, in = seen.map;
  const int own_frames = frames_in(map, own_map), in_frames = frames_in(map, in);
  const SetId first_set = std::max(first_set_in(map, own_map), first_set_in(map, in));
  // One in metres keeps its frame; else the larger, the older one when they are equal.
  const auto rank = [&](MapId id, int frames) { return std::pair(map.is_metric(id), frames); };
  if (rank(own_map, own_frames) > rank(in, in_frames) ||
      (rank(own_map, own_frames) == rank(in, in_frames) && own_map < in)) {
    edit.merge(in, own_map, in_from_own.inverse());
  } else {
    edit.merge(own_map, in, in_from_own);
  }
  bind_matches(edit, image, seen.matches);
  return first_set;
}

bool close(PlaceRecognitionEdit& edit, const DescribedImage& image, const PlaceMatch& seen,
           const Similarity3& in_from_own, const ViewGraph& graph, std::vector<LoopConstraint>* loops) {
  const MapCamera& camera = image.camera;
  const FramePose* key_frame = edit.map().camera(seen.key_camera).frame_at(seen.key_set);
  const LoopConstraint loop{camera.id,
                            seen.key_camera,
                            image.set,
                            seen.key_set,
                            seen.cam_from_world * key_frame->cam_from_world.inverse(),
                            in_from_own.scale};
  if (!close_loop(edit, camera.map, loop, *loops, graph.group_with(camera.id))) return false;
  loops->push_back(loop);
  bind_matches(edit, image, seen.matches);
  return true;
}

}  // namespace coslam
