// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/observe/result_store.h"

#include <algorithm>
#include <set>

#include "common/base/error.h"
#include "common/base/log.h"

namespace coslam {
namespace {

constexpr std::uint32_t kTrackEvery = 10;  // frames

std::uint8_t grey_of(const MapPoint& p) { return p.patches.empty() ? 128 : p.patches.front().pixels[kPatchBytes / 2]; }

std::vector<ResultPoint> result_points(const Map& map, MapId of) {
  std::vector<ResultPoint> out;
  for (const auto& [id, p] : map.points()) {
    if (p.map != of) continue;
    out.push_back({id, p.position, p.covariance, told_state(p.phase), p.first_ns, p.last_ns, static_cast<int>(p.views),
                   grey_of(p)});
  }
  return out;
}

// Paths of moving points, by the final poses.
std::map<PointId, MovingPath> write_dynamic(const Map& map, MapId of, DynamicWriter* writer) {
  std::map<PointId, MovingPath> paths;
  std::vector<ResultDynamicRow> rows;
  for (const auto& [id, path] : map.motions()) {
    for (const MotionSample& sample : path) {
      const auto seen = position_of(map, of, sample);
      if (!seen) continue;
      rows.push_back({sample.t_ns, id, seen->at.position, seen->at.covariance, seen->views});
      paths[id].push_back({sample.set, sample.t_ns, seen->at.position});
    }
  }
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.t_ns < b.t_ns; });
  for (const ResultDynamicRow& row : rows) writer->write(row);
  return paths;
}

Trajectory final_trajectory(const MapCamera& camera, MapId of) {
  Trajectory t;
  for (const FramePose& f : camera.frames) {
    if (f.map == of) t.push_back({f.capture_ns, f.cam_from_world});
  }
  return t;
}

}  // namespace

ResultStore::ResultStore(const std::filesystem::path& folder, const EventsConfig& events)
    : folder_([&] {
        std::error_code error;
        for (const char* sub : {"trajectory", "live", "tracks"}) {
          std::filesystem::create_directories(folder / sub, error);
          if (error)
            throw UserError("cannot make the result folder " + (folder / sub).string() + ": " + error.message());
        }
        return folder;
      }()),
      groups_(folder_.groups()),
      dynamic_(folder_.dynamic()),
      object_rows_(folder_.objects()),
      events_(folder_.events(), events) {}

void ResultStore::record(const FrameSet& set, const MapServer& server) {
  for (const CameraFrame& cf : set.frames) {
    record_live(cf, server);
    if (cf.frame.frame.value % kTrackEvery == 0) record_tracks(cf, server);
  }
  record_groups(set, server);
  record_objects(set, server);
  events_.record(set.id, set.t_ns, server.journal(), server.map());
  if (const auto warning = events_.take_warning()) log_warn(*warning);
}

// In the frame of the map that the agent had been told of when it took the pose: it hears of a merge later.
void ResultStore::record_live(const CameraFrame& cf, const MapServer& server) {
  const TrackFrame& f = cf.frame;
  auto& told = told_[cf.camera];
  if (f.pose_state == PoseState::kTracked && f.server_run == server.run()) {
    const auto last =
        std::find_if(told.rbegin(), told.rend(), [&](const auto& entry) { return entry.first <= f.epoch; });
    if (last != told.rend() && last->second != MapId())
      live_[cf.camera][last->second].push_back({f.capture_ns, f.cam_from_world});
  }
  const MapId now = server.map().camera(cf.camera).map;
  if (told.empty() || told.back().second != now) told.emplace_back(server.map().epoch(), now);
}

void ResultStore::record_tracks(const CameraFrame& cf, const MapServer& server) {
  const MapCamera& camera = server.map().camera(cf.camera);
  auto& writer = tracks_[camera.name];
  if (!writer) writer = std::make_unique<TrackWriter>(folder_.tracks(camera.name));
  for (const auto& [id, track] : camera.tracks) {
    ResultTrackRow row;
    row.frame = cf.frame.frame;
    row.t_ns = cf.frame.capture_ns;
    row.track = id;
    row.raw_px = camera.model.raw_from_undistorted(track.seen.back().undistorted_px.cast<double>());
    row.point = track.point;
    if (const MapPoint* p = server.map().find(track.point)) row.state = told_state(p->phase);
    if (!track.bound() && track.moves()) row.state = PointState::kDynamic;
    writer->write(row);
  }
}

void ResultStore::record_groups(const FrameSet& set, const MapServer& server) {
  const auto& groups = server.graph().groups;
  if (groups == last_groups_) return;
  last_groups_ = groups;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    ResultGroupRow row{.t_ns = set.t_ns, .group = GroupId(static_cast<std::uint32_t>(g + 1))};
    for (const CameraId c : groups[g]) row.agents.push_back(server.map().camera(c).name);
    groups_.write(row);
  }
}

void ResultStore::record_objects(const FrameSet& set, const MapServer& server) {
  for (const MovingObject& o : server.objects()) objects_.push_back({set.t_ns, o.id, o.members});
}

// Where the members were by the final poses, and how fast by their paths before and after the instant: without the lag
// of what was known at the time.
void ResultStore::write_objects(const std::map<PointId, MovingPath>& paths) {
  constexpr double kBeside_s = 0.25, kMinSpan_s = 0.2;
  for (const SeenObject& o : objects_) {
    std::vector<PointMotion> motions;
    ResultObjectRow row{.t_ns = o.t_ns, .object = o.id};
    for (const PointId id : o.members) {
      const auto path = paths.find(id);
      if (path == paths.end()) continue;
      const auto motion =
          motion_at(path->second, o.t_ns, o.t_ns - to_ns(kBeside_s), o.t_ns + to_ns(kBeside_s), kMinSpan_s);
      if (!motion) continue;
      motions.push_back(*motion);
      row.members.push_back(id);
    }
    if (motions.empty()) continue;
    const BodyMotion body = body_of(motions);
    row.position = body.centroid;
    row.velocity_per_s = body.velocity;
    row.extent = body.extent;
    object_rows_.write(row);
  }
}

// What has no relation to the common map goes beside it, each map by itself.
void ResultStore::write_trajectories(const MapServer& server) {
  const auto save = [](const std::filesystem::path& file, const Trajectory& trajectory) {
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);  // when not, saving fails
    save_tum(file, trajectory);
  };
  for (const MapId old : folder_.separate_maps()) {
    for (const auto& file : {folder_.trajectory(old, ""), folder_.live(old, "")}) {
      std::error_code error;
      std::filesystem::remove_all(file.parent_path(), error);
    }
  }
  const MapId of = server.largest_map();
  for (const MapCamera& c : server.map().cameras()) {
    std::set<MapId> maps;
    for (const FramePose& f : c.frames) {
      if (f.valid() && f.map != of) maps.insert(f.map);
    }
    save_tum(folder_.trajectory(c.name), final_trajectory(c, of));
    for (const MapId m : maps) save(folder_.trajectory(m, c.name), final_trajectory(c, m));
    auto& live = live_[c.id];
    save_tum(folder_.live(c.name), live[of]);
    for (const auto& [m, trajectory] : live) {
      if (m != of) save(folder_.live(m, c.name), trajectory);
    }
  }
}

void ResultStore::finish(const MapServer& server, const nlohmann::ordered_json& report) {
  const MapId of = server.largest_map();
  write_trajectories(server);
  const std::vector<ResultPoint> points = result_points(server.map(), of);
  PointWriter writer(folder_.points());
  for (const ResultPoint& p : points) writer.write(p);
  writer.close();
  write_ply(folder_.map(), points);
  for (auto& [name, tracks] : tracks_) tracks->close();
  groups_.close();
  const std::map<PointId, MovingPath> paths = write_dynamic(server.map(), of, &dynamic_);
  dynamic_.close();
  write_objects(paths);
  object_rows_.close();
  events_.finish(server.journal(), server.map());
  if (const auto warning = events_.take_warning()) log_warn(*warning);
  write_json(folder_.report(), report);
}

}  // namespace coslam
