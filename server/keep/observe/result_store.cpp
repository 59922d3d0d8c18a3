// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/result_store.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <set>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/dataset/calibration.h"
#include "server/estimator/solve/corrected_calibration.h"
#include "server/keep/observe/result_rows.h"

namespace coslam {
namespace {

constexpr std::uint32_t kTrackEvery = 10;  // frames
constexpr std::size_t kMostLive = 8192;    // poses of one agent in one map that stay in memory

Trajectory final_trajectory(const MapServer& server, const ResultPast& past, const MapCamera& camera, MapId map_id,
                            SetId from_set) {
  Trajectory t = past.trajectory(server.map(), camera.id, map_id, from_set);
  for (const FramePose& f : camera.present_frames()) {
    if (f.valid() && f.map == map_id && f.set >= from_set) t.push_back({f.capture_ns, f.cam_from_world});
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
    : folder_(new_result(folder)), groups_(folder_.groups()), events_(folder_.events(), events), past_(folder) {
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

void ResultStore::take(const PastPart& past) {
  past_.add(past);
  if (!past.places) return;
  const TimeNs until_ns = past.places->places.back().t_ns;
  const auto stay = std::ranges::find_if(objects_, [&](const SeenObject& o) { return o.t_ns >= until_ns; });
  past_.add_objects({objects_.begin(), stay});
  objects_.erase(objects_.begin(), stay);
}

void ResultStore::say_problems() {
  if (const auto warning = past_.take_problem()) log_warn(*warning);
  if (const auto warning = events_.take_warning()) log_warn(*warning);
  const auto say = [](CsvWriter& file) {
    if (const auto problem = file.take_problem()) log_warn(*problem + what_becomes_of(file.ended()));
  };
  say(groups_);
  for (const auto& [name, tracks] : tracks_) {
    if (tracks) say(tracks->file());
  }
}

// In the frame of the map that the agent had been told of when it took the pose: it hears of a merge later.
void ResultStore::record_live(const CameraFrame& cf, const MapServer& server) {
  const TrackFrame& f = cf.frame;
  auto& announced = announced_[cf.camera];
  if (f.pose_state == PoseState::kTracked && f.server_run == server.run()) {
    const auto last =
        std::find_if(announced.rbegin(), announced.rend(), [&](const auto& entry) { return entry.first <= f.epoch; });
    if (last != announced.rend() && last->second != MapId()) {
      Trajectory& live = live_[cf.camera][last->second];
      live.push_back({f.capture_ns, f.cam_from_world});
      if (live.size() >= kMostLive) {
        past_.add_live(cf.camera, last->second, live);
        live.clear();
      }
    }
  }
  const MapId now = server.map().camera(cf.camera).map;
  if (announced.empty() || announced.back().second != now) announced.emplace_back(server.map().epoch(), now);
}

TrackStore* ResultStore::tracks_of(const std::string& agent) {
  const auto [at, is_new] = tracks_.try_emplace(agent);
  if (!is_new) return at->second.get();
  try {
    at->second = std::make_unique<TrackStore>(folder_.tracks(agent));
  } catch (const UserError& e) {
    log_warn(std::string(e.what()) + "; mapping goes on without the file");
    not_made_.emplace_back(e.what());
  }
  return at->second.get();
}

void ResultStore::record_tracks(const CameraFrame& cf, const MapServer& server) {
  const MapCamera& camera = server.map().camera(cf.camera);
  if (TrackStore* store = tracks_of(camera.name)) store->record(cf.frame, camera, server.map());
}

void ResultStore::record_groups(const FrameSet& set, const MapServer& server) {
  const auto& groups = server.report<ViewGraph>().groups;
  if (groups == last_groups_) return;
  last_groups_ = groups;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    ResultGroupRow row{.t_ns = set.t_ns, .group = GroupId(static_cast<std::uint32_t>(g + 1))};
    for (const CameraId c : groups[g]) row.agents.push_back(server.map().camera(c).name);
    groups_.write(row);
  }
}

void ResultStore::record_objects(const FrameSet& set, const MapServer& server) {
  for (const MovingObject& o : server.report<ObjectsReport>().list) objects_.push_back({set.t_ns, o.id, o.members});
}

Trajectory ResultStore::live_of(CameraId camera, MapId map) const {
  Trajectory all = past_.live(camera, map);
  const auto live_maps = live_.find(camera);
  if (live_maps == live_.end() || !live_maps->second.contains(map)) return all;
  const Trajectory& newest = live_maps->second.at(map);
  all.insert(all.end(), newest.begin(), newest.end());
  return all;
}

// Of all maps; what has no relation to the common one goes beside it, each map by itself.
void ResultStore::write_paths(const MapServer& server, Attempts& attempts) {
  const std::vector<MapFrames> maps = server.maps();
  const MapId common = server.largest_map();
  const auto unit = [&](MapId map) { return unit_of(server.scale_known(map)); };
  for (const MapCamera& c : server.map().cameras()) {
    const auto met_since = server.met_since(c.id);
    if (!met_since) continue;  // of another day
    const auto& live = live_[c.id];
    const auto final_path = [&](MapId m) { return final_trajectory(server, past_, c, m, *met_since); };
    attempts([&] { save_tum(folder_.trajectory(c.name), final_path(common), unit(common)); });
    attempts([&] { save_tum(folder_.live(c.name), live_of(c.id, common), unit(common)); });
    std::set<MapId> apart;
    for (const MapFrames& m : maps) {
      if (m.map == common) continue;
      apart.insert(m.map);
      const ResultFolder folder = folder_.of_map(m.map);
      if (m.frames.contains(c.id)) {
        attempts([&] { save_tum(folder.trajectory(c.name), final_path(m.map), unit(m.map)); });
      }
      if (live.contains(m.map)) attempts([&] { save_tum(folder.live(c.name), live_of(c.id, m.map), unit(m.map)); });
    }
    for (const auto& past : live) {
      const MapId m = past.first;
      if (m != common && !apart.contains(m))
        attempts([&] { save_tum(folder_.live_before(m, c.name), live_of(c.id, m), LengthUnit::kMapUnits); });
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
  attempts([&] { write_ply(folder.map(), points, unit_of(server.scale_known(map))); });
  write_moving(server, map, folder, attempts);
}

void ResultStore::write_moving(const MapServer& server, MapId map, const ResultFolder& folder,
                               Attempts& attempts) const {
  const std::vector<ResultDynamicRow> rows = moving_rows(server.map(), map);
  const auto for_each_row = [&](const std::function<void(const ResultDynamicRow&)>& visit) {
    past_.for_each_place(server.map(), map, visit);
    for (const ResultDynamicRow& row : rows) visit(row);
  };
  attempts([&] {
    DynamicWriter writer(folder.dynamic());
    for_each_row([&](const ResultDynamicRow& row) { writer.write(row); });
    writer.close();
  });
  attempts([&] {
    ObjectWriter writer(folder.objects());
    ObjectRows objects(&writer);
    std::size_t block = 0;
    const auto add_objects = [&](TimeNs until_ns) {
      while (block <= past_.object_blocks() && objects.known_until_ns() < until_ns) {
        objects.add(block < past_.object_blocks() ? past_.objects(block) : objects_);
        ++block;
      }
    };
    for_each_row([&](const ResultDynamicRow& row) {
      add_objects(row.t_ns + to_ns(1));
      objects.add(row);
    });
    add_objects(std::numeric_limits<TimeNs>::max());
    objects.finish();
    writer.close();
  });
}

// The files that grew during the run.
void ResultStore::check_streams(bool last, Attempts& attempts) {
  const auto check = [&](CsvWriter& file) { attempts([&] { last ? file.close() : file.check(); }); };
  check(groups_);
  for (const auto& of_agent : tracks_) {
    TrackStore* tracks = of_agent.second.get();
    if (tracks == nullptr) continue;
    check(tracks->file());
    if (last) attempts([&] { tracks->mark_earlier_motion(); });
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
  for (const MapCamera& c : server.map().cameras()) {
    if (c.lens.none() || !server.met_since(c.id)) continue;
    attempts([&] {
      const std::filesystem::path file = folder_.calibration(c.name);
      std::filesystem::create_directories(file.parent_path());
      save_calibration(file, corrected_calibration(c.model, c.lens).camera);
    });
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
