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

// Of moving points, by the poses that cameras have now.
struct MovingPaths {
  std::vector<ResultDynamicRow> rows;  // ascending time
  std::map<PointId, MovingPath> by_point;
};

MovingPaths moving_paths(const Map& map, MapId of) {
  MovingPaths out;
  for (const auto& [id, path] : map.motions()) {
    for (const MotionSample& sample : path) {
      const auto seen = position_of(map, of, sample);
      if (!seen) continue;
      out.rows.push_back({sample.t_ns, id, seen->at.position, seen->at.covariance, seen->views});
      out.by_point[id].push_back({sample.set, sample.t_ns, seen->at.position});
    }
  }
  std::ranges::stable_sort(out.rows, {}, &ResultDynamicRow::t_ns);
  return out;
}

Trajectory final_trajectory(const MapCamera& camera, MapId of, SetId since) {
  Trajectory t;
  for (const FramePose& f : camera.frames) {
    if (f.valid() && f.map == of && f.set >= since) t.push_back({f.capture_ns, f.cam_from_world});
  }
  return t;
}

ResultFolder new_result(const std::filesystem::path& folder) {
  ResultFolder result(folder);
  if (result.holds_run()) throw UserError(folder.string() + " holds a run already");
  for (const char* sub : {"trajectory", "live", "tracks"}) {
    std::error_code error;
    std::filesystem::create_directories(folder / sub, error);
    if (error) throw UserError("cannot make the result folder " + (folder / sub).string() + ": " + error.message());
  }
  return result;
}

}  // namespace

// Writes one file after the other, whatever becomes of each.
class ResultStore::Attempts {
 public:
  template <class Write>
  void operator()(Write&& write) {
    try {
      write();
    } catch (const UserError& e) {
      if (++failed_ == 1) first_ = e.what();
    }
  }
  void raise() const {
    if (failed_ == 1) throw UserError(first_);
    if (failed_ > 1) throw UserError(first_ + "; nor can " + std::to_string(failed_ - 1) + " more files of the result");
  }

 private:
  std::string first_;
  int failed_ = 0;
};

ResultStore::ResultStore(const std::filesystem::path& folder, const EventsConfig& events)
    : folder_(new_result(folder)), groups_(folder_.groups()), events_(folder_.events(), events) {
  groups_.check();
}

void ResultStore::record(const FrameSet& set, const MapServer& server) {
  for (const CameraFrame& cf : set.frames) {
    record_live(cf, server);
    if (cf.frame.frame.value % kTrackEvery == 0) record_tracks(cf, server);
  }
  record_groups(set, server);
  record_objects(set, server);
  events_.record(set.id, set.t_ns, server.journal(), server.map());
  say_problems();
}

void ResultStore::say_problems() {
  if (const auto warning = events_.take_warning()) log_warn(*warning);
  const auto say = [](CsvWriter& file) {
    if (const auto problem = file.take_problem()) log_warn(*problem + "; mapping goes on, the file ends here");
  };
  say(groups_);
  for (const auto& [name, tracks] : tracks_) {
    if (tracks) say(*tracks);
  }
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

TrackWriter* ResultStore::tracks_of(const std::string& agent) {
  const auto [at, is_new] = tracks_.try_emplace(agent);
  if (!is_new) return at->second.get();
  try {
    at->second = std::make_unique<TrackWriter>(folder_.tracks(agent));
  } catch (const UserError& e) {
    log_warn(std::string(e.what()) + "; mapping goes on without the file");
    not_made_.emplace_back(e.what());
  }
  return at->second.get();
}

void ResultStore::record_tracks(const CameraFrame& cf, const MapServer& server) {
  const MapCamera& camera = server.map().camera(cf.camera);
  TrackWriter* writer = tracks_of(camera.name);
  if (writer == nullptr) return;
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
void ResultStore::write_objects(const std::map<PointId, MovingPath>& paths, ObjectWriter* writer) const {
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
    writer->write(row);
  }
}

// Of all maps; what has no relation to the common one goes beside it, each map by itself.
void ResultStore::write_paths(const MapServer& server, Attempts& attempts) {
  const std::vector<MapFrames> maps = server.maps();
  const MapId common = server.largest_map();
  for (const MapCamera& c : server.map().cameras()) {
    const auto since = server.met_since(c.id);
    if (!since) continue;  // of another day
    auto& live = live_[c.id];
    attempts([&] { save_tum(folder_.trajectory(c.name), final_trajectory(c, common, *since)); });
    attempts([&] { save_tum(folder_.live(c.name), live[common]); });
    std::set<MapId> apart;
    for (const MapFrames& m : maps) {
      if (m.map == common) continue;
      apart.insert(m.map);
      const ResultFolder folder = folder_.of_map(m.map);
      if (m.frames.contains(c.id)) {
        attempts([&] { save_tum(folder.trajectory(c.name), final_trajectory(c, m.map, *since)); });
      }
      if (live.contains(m.map)) attempts([&] { save_tum(folder.live(c.name), live[m.map]); });
    }
    for (const auto& past : live) {
      const MapId m = past.first;
      if (m != common && !apart.contains(m)) attempts([&] { save_tum(folder_.live_before(m, c.name), past.second); });
    }
  }
}

void ResultStore::write_map(const MapServer& server, MapId map, const ResultFolder& folder, Attempts& attempts) {
  const std::vector<ResultPoint> points = result_points(server.map(), map);
  attempts([&] {
    PointWriter writer(folder.points());
    for (const ResultPoint& p : points) writer.write(p);
    writer.close();
  });
  attempts([&] { write_ply(folder.map(), points); });
  write_moving(server, map, folder, attempts);
}

void ResultStore::write_moving(const MapServer& server, MapId map, const ResultFolder& folder,
                               Attempts& attempts) const {
  const MovingPaths paths = moving_paths(server.map(), map);
  attempts([&] {
    DynamicWriter writer(folder.dynamic());
    for (const ResultDynamicRow& row : paths.rows) writer.write(row);
    writer.close();
  });
  attempts([&] {
    ObjectWriter writer(folder.objects());
    write_objects(paths.by_point, &writer);
    writer.close();
  });
}

// The files that grew during the run.
void ResultStore::check_streams(bool last, Attempts& attempts) {
  const auto check = [&](CsvWriter& file) { attempts([&] { last ? file.close() : file.check(); }); };
  check(groups_);
  for (const auto& [name, tracks] : tracks_) {
    if (tracks) check(*tracks);
  }
  for (const std::string& sentence : not_made_) attempts([&] { throw UserError(sentence); });
}

// The report comes last: with it the result is whole.
void ResultStore::write_maps(const MapServer& server, const nlohmann::ordered_json& report, Attempts& attempts) {
  const MapId common = server.largest_map();
  write_map(server, common, folder_, attempts);
  for (const MapFrames& m : server.maps()) {
    if (m.map != common) write_map(server, m.map, folder_.of_map(m.map), attempts);
  }
  attempts([&] { write_json(folder_.report(), report); });
}

// The paths first: they are small, and matter most when the disk is full.
void ResultStore::write(const MapServer& server, const nlohmann::ordered_json& report) {
  Attempts attempts;
  write_paths(server, attempts);
  check_streams(false, attempts);
  attempts([&] { events_.end_for_now(); });
  write_maps(server, report, attempts);
  attempts.raise();
}

void ResultStore::finish(const MapServer& server, const nlohmann::ordered_json& report) {
  Attempts attempts;
  write_paths(server, attempts);
  check_streams(true, attempts);
  attempts([&] { events_.finish(server.journal(), server.map()); });
  if (const auto warning = events_.take_warning()) log_warn(*warning);
  write_maps(server, report, attempts);
  attempts.raise();
}

}  // namespace coslam
