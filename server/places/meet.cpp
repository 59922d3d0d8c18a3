// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/places/meet.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/pose_refinement.h"
#include "common/geometry/robust.h"
#include "server/associate/register.h"
#include "server/associate/track_grid.h"
#include "server/covisibility/disjoint_sets.h"
#include "server/covisibility/overlap.h"

namespace coslam {
namespace {

constexpr double kHint_s = 0.67;  // in which a place that may have been recognised is looked at closely

bool together(const ViewGraph& graph, CameraId a, CameraId b) {
  const int group = graph.group_of(a);
  return a == b || (group >= 0 && group == graph.group_of(b));
}

std::vector<const MapPoint*> points_of(const Map& map, const Recognition& seen) {
  std::vector<const MapPoint*> out;
  for (const auto& [track, point] : seen.matches) out.push_back(map.find(point));
  return out;
}

// Depth of the camera's own map at a track: of its point, or of that of the nearest track not far from it.
std::optional<double> own_depth(const Map& map, const MapCamera& camera, const ServerTrack& track, bool exact) {
  constexpr double kNear = 0.025;  // of the image width
  const MapPoint* best = map.find(track.point);
  if (best == nullptr && !exact) {
    float nearest = static_cast<float>(kNear * camera.model.width_px);
    for (const auto& [id, t] : camera.tracks) {
      const MapPoint* p = map.find(t.point);
      if (p == nullptr || !p->rests()) continue;
      const float d = (t.seen.back().undistorted_px - track.seen.back().undistorted_px).norm();
      if (d >= nearest) continue;
      nearest = d;
      best = p;
    }
  }
  if (best == nullptr || !best->rests()) return std::nullopt;
  return (camera.frames.back().cam_from_world * best->position).z();
}

// Lengths in the place's map over those in the camera's own, from depths in both; empty when they do not agree.
std::optional<double> scale_of(const Map& map, const MapCamera& camera, const Recognition& seen) {
  constexpr std::size_t kLeast = 10;
  constexpr double kMostSpread = 0.3;  // between the quartiles of the logarithm
  std::vector<double> ratios;
  for (const bool exact : {true, false}) {
    ratios.clear();
    for (const auto& [track, point] : seen.matches) {
      const auto own = own_depth(map, camera, camera.tracks.at(track), exact);
      const double other = (seen.cam_from_world * map.find(point)->position).z();
      if (own && *own > 0 && other > 0) ratios.push_back(std::log(other / *own));
    }
    if (ratios.size() >= kLeast) break;
  }
  if (ratios.size() < kLeast) return std::nullopt;
  std::sort(ratios.begin(), ratios.end());
  if (ratios[ratios.size() * 3 / 4] - ratios[ratios.size() / 4] > kMostSpread) return std::nullopt;
  return std::exp(ratios[ratios.size() / 2]);
}

// From the camera's pose in both.
std::optional<Similarity3> similarity_of(const Map& map, const MapCamera& camera, const Recognition& seen) {
  const auto scale = scale_of(map, camera, seen);
  if (!scale) return std::nullopt;
  const Rigid3& own = camera.frames.back().cam_from_world;
  Similarity3 s;
  s.scale = *scale;
  s.rotation = (seen.cam_from_world.rotation.conjugate() * own.rotation).normalized();
  s.translation = seen.cam_from_world.center() - s.scale * (s.rotation * own.center());
  return s;
}

// Tracks that matched a point of the place are bound to it; a point of their own becomes one with it.
void bind_matches(MapEdit& edit, const MapCamera& camera, const std::vector<std::pair<TrackId, PointId>>& matches) {
  const Map& map = edit.map();
  const Figures agree{static_cast<double>(matches.size()), 0};
  for (const auto& [track_id, point_id] : matches) {
    const ServerTrack& t = camera.tracks.at(track_id);
    const MapPoint* kept = map.find(point_id);
    if (kept == nullptr || t.point == point_id) continue;
    if (const MapPoint* own = map.find(t.point); own == nullptr) {
      if (seen_by(*kept, camera.id)) continue;
      edit.bind(*kept, camera.id, t, Why::kPlaceRecognised, agree);
    } else {
      if (!own->rests() || seen_at_once(*own, *kept)) continue;
      edit.fuse(point_id, t.point, Why::kPlaceRecognised, agree);
    }
    edit.keep_recent(*kept);
    retriangulate(edit, *kept);
  }
}

void place(MapEdit& edit, const MapCamera& camera, const Recognition& seen, const LocaliseConfig& config) {
  edit.place(camera, camera.frames.back().set, seen.map, seen.cam_from_world, Why::kPlaceRecognised,
             {static_cast<double>(seen.matches.size()), 0});
  bind_matches(edit, camera, seen.matches);
  localise_backwards(edit, camera, camera.frames.back().set, config);
  edit.raise_epoch();
}

// It had a pose in that map not long ago, and not far from there.
bool where_it_was_lost(const MapCamera& camera, const Recognition& seen) {
  constexpr double kLately_s = 10, kNear = 1.0;  // of the distance of what it sees
  const TimeNs now_ns = camera.frames.back().capture_ns;
  for (std::size_t i = camera.frames.size(); i-- > 0;) {
    const FramePose& f = camera.frames[i];
    if (to_seconds(now_ns - f.capture_ns) > kLately_s) return false;
    if (!f.valid()) continue;
    return f.map == seen.map &&
           (f.cam_from_world.center() - seen.cam_from_world.center()).norm() < kNear * seen.median_depth;
  }
  return false;
}

int frames_in(const Map& map, MapId id) {
  int n = 0;
  for (const MapCamera& c : map.cameras()) {
    n += static_cast<int>(
        std::count_if(c.frames.begin(), c.frames.end(), [&](const FramePose& f) { return f.map == id; }));
  }
  return n;
}

// The known points lie where the camera's own pose expects them.
bool as_expected(const Map& map, const MapCamera& camera, const Recognition& seen, double most_px) {
  std::vector<double> errors;
  for (const auto& [track, point] : seen.matches) {
    Eigen::Vector2d px;
    if (!project_world(camera.model, camera.frames.back().cam_from_world, map.find(point)->position, &px, nullptr))
      return false;
    errors.push_back((px - camera.tracks.at(track).seen.back().undistorted_px.cast<double>()).norm());
  }
  return upper_median(errors) < most_px;
}

bool several_maps(const Map& map) {
  MapId seen;
  for (const MapCamera& c : map.cameras()) {
    if (!c.alive || c.frames.empty() || c.map == MapId()) continue;
    if (seen != MapId() && c.map != seen) return true;
    seen = c.map;
  }
  return false;
}

double median_depth(const Map& map, const MapCamera& camera) {
  std::vector<double> depths;
  for (const auto& [id, t] : camera.tracks) {
    const MapPoint* p = map.find(t.point);
    if (p != nullptr && p->rests()) depths.push_back((camera.frames.back().cam_from_world * p->position).z());
  }
  return upper_median(depths);
}

}  // namespace

MeetReport Meetings::run(MapEdit& edit, const FrameSet& set, Last<ViewGraph> last, const LocaliseConfig& localise,
                         const GroupConfig& group) {
  const Map& map = edit.map();
  const ViewGraph& graph = last.of;
  MeetReport report;
  expect(map, set, graph, group.min_shared);
  for (const CameraFrame& cf : set.frames) {
    if (!cf.descriptors) continue;
    recognise(edit, cf, graph, localise, &report);
  }
  for (const CameraFrame& cf : set.frames) {
    if (!cf.descriptors) continue;
    places_.add(edit, cf);
    ++report.described;
    described_[cf.camera].at = set.id;
  }
  const bool apart = several_maps(map);
  for (const CameraFrame& cf : set.frames) {
    const DescriptorRequest r = request(map, map.camera(cf.camera), apart, graph.groups.size() > 1);
    if (r == DescriptorRequest::kNone) continue;
    described_[cf.camera].asked = set.id;
    report.requests[cf.camera] = r;
  }
  return report;
}

// Which cameras see what a camera should see too without being held to it, by the points that two cameras see at once;
// looked at now and then.
void Meetings::expect(const Map& map, const FrameSet& set, const ViewGraph& graph, int min_holding) {
  constexpr double kPeriod_s = 0.13;
  if (!map.every(kPeriod_s)) return;
  expected_.clear();
  DisjointSets held(map.cameras().size());
  for (const ViewEdge& e : graph.edges) {
    if (e.shared >= min_holding) held.unite(e.first.value, e.second.value);
  }
  ViewOverlap overlap(map);
  for (std::size_t i = 0; i < set.frames.size(); ++i) {
    for (std::size_t j = i + 1; j < set.frames.size(); ++j) {
      const CameraId a = set.frames[i].camera, b = set.frames[j].camera;
      if (held.find(a.value) == held.find(b.value)) continue;
      if (overlap.between(a, b).least() < config.min_overlap) continue;
      expected_[a].push_back(b);
      expected_[b].push_back(a);
    }
  }
}

ExpectedPlace Meetings::find_expected(const Map& map, const CameraFrame& frame) const {
  const auto others = expected_.find(frame.camera);
  if (others == expected_.end()) return {};
  const std::uint32_t lately = 2 * map.sets_in(config.soon_s);
  const SetId since(map.now().value - std::min(map.now().value, lately));
  return places_.find_expected(map, frame, others->second, since, slack_px(map, map.camera(frame.camera)));
}

bool Meetings::may_ask(const Map& map, const MapCamera& camera, const ViewGraph& graph, const KeyImage& image,
                       MapId in) const {
  if (camera.map == MapId() || in != camera.map) return true;
  if (!map.is_recent(image.set)) return config.loops;
  const auto expected = expected_.find(camera.id);
  return !together(graph, camera.id, image.camera) ||
         (expected != expected_.end() && std::ranges::find(expected->second, image.camera) != expected->second.end());
}

void Meetings::recognise(MapEdit& edit, const CameraFrame& frame, const ViewGraph& graph,
                         const LocaliseConfig& localise, MeetReport* report) {
  const Map& map = edit.map();
  const MapCamera& camera = map.camera(frame.camera);
  const bool unplaced = camera.map == MapId();
  if (!unplaced && !camera.frames.back().valid()) return;
  ExpectedPlace expected = find_expected(map, frame);
  if (!expected.there.empty()) {
    bind_matches(edit, camera, expected.there);
    ++report->expected;
    return;
  }
  auto seen = places_.find(map, frame, [&](const KeyImage& i, MapId in) { return may_ask(map, camera, graph, i, in); });
  const bool enough = seen && (unplaced || static_cast<int>(seen->matches.size()) >= config.min_merge_inliers);
  if (!enough && expected.beside) seen = std::move(expected.beside);
  if (!seen) return;
  ++report->sightings;
  if (unplaced) {
    if (!has_relief(points_of(map, *seen), seen->median_depth) && !where_it_was_lost(camera, *seen)) {
      ++report->doubted;
      return;
    }
    place(edit, camera, *seen, localise);
    ++report->placed;
  } else if (!enough && !seen->expected) {
    described_[camera.id].hinted = map.now();
  } else {
    draw_together(edit, camera, *seen, graph, report);
  }
}

void Meetings::draw_together(MapEdit& edit, const MapCamera& camera, const Recognition& seen, const ViewGraph& graph,
                             MeetReport* report) {
  const Map& map = edit.map();
  if (seen.map == camera.map && as_expected(map, camera, seen, slack_px(map, camera))) {
    bind_matches(edit, camera, seen.matches);
    ++report->linked;
    return;
  }
  const auto similarity = similarity_of(map, camera, seen);
  if (!similarity || !verification_.confirmed(map, camera, seen, *similarity, graph)) {
    ++report->doubted;
    return;
  }
  if (seen.map == camera.map) {
    close(edit, camera, seen, *similarity, graph, report);
  } else {
    join(edit, camera, seen, *similarity, report);
  }
}

void Meetings::join(MapEdit& edit, const MapCamera& camera, const Recognition& seen, const Similarity3& in_from_own,
                    MeetReport* report) {
  const Map& map = edit.map();
  const MapId own = camera.map, in = seen.map;
  const int own_frames = frames_in(map, own), in_frames = frames_in(map, in);
  // The larger map keeps its frame; the older one when they are equal.
  if (own_frames > in_frames || (own_frames == in_frames && own < in)) {
    edit.merge(in, own, in_from_own.inverse());
  } else {
    edit.merge(own, in, in_from_own);
  }
  bind_matches(edit, camera, seen.matches);
  verification_.clear();
  ++report->merged;
  report->to_adjust = camera.map;
}

void Meetings::close(MapEdit& edit, const MapCamera& camera, const Recognition& seen, const Similarity3& in_from_own,
                     const ViewGraph& graph, MeetReport* report) {
  const Map& map = edit.map();
  const FramePose* there = map.camera(seen.key_camera).frame_at(seen.key_set);
  const LoopConstraint loop{camera.id,
                            seen.key_camera,
                            camera.frames.back().set,
                            seen.key_set,
                            seen.cam_from_world * there->cam_from_world.inverse(),
                            in_from_own.scale};
  if (!close_loop(edit, camera.map, loop, loops_, graph.group_with(camera.id))) return;
  loops_.push_back(loop);
  bind_matches(edit, camera, seen.matches);
  verification_.clear();
  ++report->closed;
  report->to_adjust = camera.map;
}

DescriptorRequest Meetings::request(const Map& map, const MapCamera& camera, bool apart, bool parted) {
  Described& d = described_[camera.id];
  const auto since = [&](const std::optional<SetId>& set) { return set ? map.now().value - set->value : 1U << 30U; };
  const auto due = [&](double period_s) { return since(d.asked) >= map.sets_in(period_s); };
  if (camera.map == MapId()) {
    return due(config.soon_s) ? DescriptorRequest::kEverywhere : DescriptorRequest::kNone;
  }
  if (!camera.frames.back().valid()) return DescriptorRequest::kNone;
  const bool hinted = d.hinted && since(d.hinted) < map.sets_in(kHint_s);
  const Verification::Waiting waiting = verification_.waiting(map, camera.id);
  const bool confirm = hinted || waiting != Verification::Waiting::kNothing;
  const bool expects = expected_.contains(camera.id);
  const bool wanted = confirm ? due(config.soon_s)
                      : !d.at ? due(config.soon_s)
                      : (apart && due(config.apart_period_s)) || (expects && due(config.soon_s))
                          ? true
                          : due(parted ? config.least_period_s / 2 : config.least_period_s) &&
                                view_changed(map, camera, *d.at, parted ? 0.5 : 1.0);
  if (!wanted || !afford(d, map.now_ns(), confirm)) return DescriptorRequest::kNone;
  const bool everywhere = apart || hinted || waiting == Verification::Waiting::kAnywhere;
  return everywhere ? DescriptorRequest::kEverywhere : DescriptorRequest::kAtTracks;
}

// Whether the uplink has room for an image's descriptors; if so, it is counted. What is about to be confirmed may run
// into debt.
bool Meetings::afford(Described& d, TimeNs now_ns, bool confirm) const {
  constexpr double kDebt = 2;
  d.images_to_spare =
      d.counted_ns
          ? std::min(config.image_burst, d.images_to_spare + config.images_per_s * to_seconds(now_ns - *d.counted_ns))
          : config.image_burst;
  d.counted_ns = now_ns;
  if (d.images_to_spare < (confirm ? 1 - kDebt : 1)) return false;
  d.images_to_spare -= 1;
  return true;
}

// By a share of what is configured.
bool Meetings::view_changed(const Map& map, const MapCamera& camera, SetId since, double share) const {
  const FramePose* then = camera.frame_at(since);
  const FramePose& now = camera.frames.back();
  if (then == nullptr || then->map != now.map) return true;
  const double turned = then->cam_from_world.rotation.angularDistance(now.cam_from_world.rotation);
  const double moved = (then->cam_from_world.center() - now.cam_from_world.center()).norm();
  return turned > share * config.turned_rad || moved > share * config.moved_share * median_depth(map, camera);
}

}  // namespace coslam
