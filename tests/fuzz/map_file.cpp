// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The rows of a map file, as SQLite and their check sums let them through: a table, a number, the length of the octets
// in two octets, and these, again and again. They become a map that can be looked at, or are refused with a sentence.
// Rows that stages keep beside the map are not among them.
#include <algorithm>
#include <array>
#include <cstring>
#include <string>

#include "server/estimator/map/edit.h"
#include "server/estimator/map/past.h"
#include "server/estimator/map/validate.h"
#include "tests/fuzz/fuzzer.h"
#include "tests/support/sim_map.h"

namespace coslam {
namespace {

constexpr std::array kNames{"state", "camera", "frame", "motion", "point", kPastFramesTable, kPastPlacesTable};
constexpr std::size_t kHead = 1 + sizeof(std::int64_t) + sizeof(std::uint16_t);

Tables tables_of(std::string_view octets) {
  Tables tables;
  while (octets.size() >= kHead) {
    std::int64_t key = 0;
    std::uint16_t size = 0;
    std::memcpy(&key, octets.data() + 1, sizeof key);
    std::memcpy(&size, octets.data() + 1 + sizeof key, sizeof size);
    const auto table = static_cast<unsigned char>(octets[0]) % kNames.size();
    octets.remove_prefix(kHead);
    tables[kNames.at(table)][key] = octets.substr(0, size);
    octets.remove_prefix(std::min<std::size_t>(size, octets.size()));
  }
  return tables;
}

std::string octets_of(const std::vector<Row>& rows) {
  std::string out;
  for (const Row& row : rows) {
    const auto size = static_cast<std::uint16_t>(row.bytes.size());
    out += static_cast<char>(std::ranges::find(kNames, row.table) - kNames.begin());
    out.append(reinterpret_cast<const char*>(&row.key), sizeof row.key);
    out.append(reinterpret_cast<const char*>(&size), sizeof size);
    out += row.bytes;
  }
  return out;
}

// As the programs look at a map that was restored.
void look_at(const Map& map) {
  map.recent_points();
  for (const auto& [id, point] : map.points()) {
    map.key_views_of(point);
    map.covariance_of(point);
  }
  for (const MapCamera& camera : map.cameras()) {
    for (const FramePose& frame : camera.present_frames()) camera.pose_at(frame.set, frame.capture_ns);
    for (const auto& [id, track] : camera.tracks) map.views_of(camera, track, 3);
  }
}

// Two cameras that see few points.
std::vector<Row> small_map(int moving_points) {
  const test::SimWorld world({.points = 4, .moving_points = moving_points});
  test::SimMap sim(world, test::paths_side_by_side(2), {.noise_px = 0});
  sim.ingest();
  sim.place_truly();
  sim.add_points();
  for (const auto& [id, point] : sim.map.points()) {
    if (world.moves(sim.world_point(point))) sim.set_moving(point);
  }
  sim.advance();
  return MapRows().changes(sim.map);
}

std::vector<Row> small_past() {
  PastPart past;
  past.frames.push_back({{}, CameraId(0), {FramePose{SetId(1), FrameId(1), 5, MapId(1), {}, false, {}}}});
  past.places = PastPlaces{{}, {PastPlace{.t_ns = 5, .point = PointId(1), .set = SetId(1), .map = MapId(1)}}};
  return rows_of(past);
}

}  // namespace

void fuzz::try_octets(Octets octets) {
  const Tables tables = tables_of(text_of(octets));
  const auto past = [&](const char* name, auto read) {
    const auto table = tables.find(name);
    if (table == tables.end()) return;
    for (const auto& [key, row] : table->second) read(row);
  };
  MapEdit edit(MapConfig{});
  edit.restore(tables);
  past(kPastFramesTable, [&](const std::string& row) {
    const PastFrames block = past_frames_of(row);
    validate(block, edit.map());
    frames_now(edit.map(), block);
  });
  past(kPastPlacesTable, [&](const std::string& row) { validate(past_places_of(row), edit.map()); });
  look_at(edit.map());
  MapRows().changes(edit.map());
}

void fuzz::write_seeds(const WriteSeed& write) {
  const std::vector<Row> still = small_map(0);
  write("still", octets_of(still));
  write("moving", octets_of(small_map(2)));
  write("past", octets_of(still) + octets_of(small_past()));
}

}  // namespace coslam
