// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "common/base/text.h"
#include "common/flow/clock.h"
#include "deploy/coslam/commands.h"
#include "deploy/coslam/console.h"
#include "deploy/coslam/map_result.h"
#include "server/estimator/map/validate.h"
#include "server/keep/store/map_file.h"

namespace coslam {
namespace {

using Access = MapFile::Access;

struct MapArguments {
  std::string file, folder;
  std::vector<std::string> other_files;
};

struct MapCensus {
  int points = 0, moving = 0;
  std::map<CameraId, int> frames;
};

std::map<MapId, MapCensus> census(const Map& map) {
  std::map<MapId, MapCensus> maps;
  for (const auto& [id, p] : map.points()) {
    ++maps[p.map].points;
    if (p.moves()) ++maps[p.map].moving;
  }
  for (const MapCamera& c : map.cameras()) {
    for (const auto& [id, frames] : c.past.placed) maps[id].frames[c.id] += frames;
    for (const FramePose& f : c.present_frames()) {
      if (f.valid()) ++maps[f.map].frames[c.id];
    }
  }
  return maps;
}

// To be written, but not made: there has to be one.
void require_map(const std::string& file) { const MapFile existing(file, Access::kRead); }

int list(const MapArguments& arguments) {
  const MapFile file(arguments.file, Access::kRead);
  const MapServer server = load_map(file);
  const Map& map = server.map();
  const double mib = static_cast<double>(std::filesystem::file_size(file.path())) / (1U << 20U);
  std::printf("%s: %.1f MiB, saved %s\n", file.path().c_str(), mib,
              file.saved_ns() ? format_utc(*file.saved_ns(), "%Y-%m-%d %H:%M:%S UTC").c_str() : "never");
  for (const auto& [id, counts] : census(map)) {
    std::printf("map %u%s: %d points, %d of them moving; key frames of all maps: %zu\n", id.value,
                map.is_metric(id) ? " (metres)" : "", counts.points, counts.moving, map.key_frames().size());
    for (const auto& [camera, frames] : counts.frames)
      std::printf("  %s: %d frames\n", map.camera(camera).name.c_str(), frames);
  }
  return 0;
}

int check(const MapArguments& arguments) {
  const MapFile file(arguments.file, Access::kRead);
  file.check();
  const MapServer server = load_map(file);
  std::printf("%s is sound: %zu points, %zu cameras\n", file.path().c_str(), server.map().points().size(),
              server.map().cameras().size());
  return 0;
}

int compact(const MapArguments& arguments) {
  require_map(arguments.file);
  const auto before = std::filesystem::file_size(arguments.file);
  MapFile file(arguments.file, Access::kWrite);
  file.check();
  file.compact();
  std::printf("%s: %ju bytes of %ju\n", file.path().c_str(), std::filesystem::file_size(file.path()), before);
  return 0;
}

int adjust(const MapArguments& arguments) {
  require_map(arguments.file);
  MapFile file(arguments.file, Access::kWrite);
  MapServer server = load_map(file);
  ProgressOfRun progress;
  server.finish_whole([&](int percent) { progress.adjusting(percent); });
  file.write(server.changed_rows(), time_of_day_ns());
  for (const std::string& warning : server.take_warnings()) std::fprintf(stderr, "coslam map: %s\n", warning.c_str());
  std::printf("%s is adjusted\n", file.path().c_str());
  return 0;
}

int copy(const MapArguments& arguments) {
  const MapFile file(arguments.file, Access::kRead);
  file.copy_to(arguments.folder);
  MapFile(arguments.folder, Access::kRead).check();
  std::printf("%s\n", arguments.folder.c_str());
  return 0;
}

int export_map(const MapArguments& arguments) {
  write_map_result(arguments.file, arguments.folder);
  std::printf("%s\n", arguments.folder.c_str());
  return 0;
}

// Of each map that came, a sentence.
void say_taken(const MapServer& server, const std::string& name, const MapServer::TakenIn& taken) {
  std::set<MapId> apart;
  for (const MapFrames& m : server.maps()) {
    if (m.map.value > taken.as.maps) apart.insert(m.map);
  }
  if (apart.empty() && taken.joined.empty()) std::printf("%s has no map that anybody was in\n", name.c_str());
  for (const JoinedMaps& j : taken.joined) {
    const bool took_other = j.remaining.value > taken.as.maps;
    apart.erase(j.remaining);
    std::printf("map %u of %s is one with map %u: %d images show its places, %d points are the same, scale %.4g\n",
                (took_other ? j.remaining : j.removed).value - taken.as.maps, name.c_str(),
                (took_other ? j.removed : j.remaining).value, j.images, j.points, j.scale);
  }
  for (const MapId id : apart) {
    std::printf("map %u of %s shows no place that is known: it stays a map of its own, %u\n", id.value - taken.as.maps,
                name.c_str(), id.value);
  }
}

// What the other file has on disk only.
void take_past(const MapFile& other, const Map& map, const Renumbered& renumbered, std::vector<Row>* rows) {
  const auto add = [&](const PastPart& past) {
    std::vector<Row> past_rows = rows_of(past);
    rows->insert(rows->end(), std::make_move_iterator(past_rows.begin()), std::make_move_iterator(past_rows.end()));
  };
  other.for_each_row(kPastFramesTable, 0, kLastRow, [&](const std::string& octets) {
    PastPart past{.frames = {past_frames_of(octets)}};
    validate(past.frames.front(), map);
    renumber(renumbered, &past.frames.front());
    add(past);
  });
  other.for_each_row(kPastPlacesTable, 0, kLastRow, [&](const std::string& octets) {
    PastPart past{.places = past_places_of(octets)};
    validate(*past.places, map);
    renumber(renumbered, &*past.places);
    add(past);
  });
}

// All in one transaction: the file is as before, or has everything.
int merge(const MapArguments& arguments) {
  require_map(arguments.file);
  MapFile file(arguments.file, Access::kWrite);
  MapServer server = load_map(file);
  std::vector<Row> past;
  for (const std::string& name : arguments.other_files) {
    if (std::filesystem::exists(name) && std::filesystem::equivalent(name, arguments.file)) {
      throw UserError(name + " is the file that the others are put into");
    }
    const MapFile other(name, Access::kRead);
    const MapServer from = load_map(other);
    const MapServer::TakenIn taken = server.take_in(from);
    take_past(other, from.map(), taken.as, &past);
    say_taken(server, name, taken);
  }
  std::vector<Row> rows = server.changed_rows();
  rows.insert(rows.end(), std::make_move_iterator(past.begin()), std::make_move_iterator(past.end()));
  file.write(rows, time_of_day_ns());
  return 0;
}

using Do = int (*)(const MapArguments&);

CLI::App* add(CLI::App& map, Command& chosen, const char* name, const char* description, Do work,
              const std::shared_ptr<MapArguments>& arguments) {
  CLI::App* command = map.add_subcommand(name, description);
  command->add_option("FILE", arguments->file, "map file, as --map names it")->required();
  command->callback([=, &chosen] { chosen = [=] { return work(*arguments); }; });
  return command;
}

}  // namespace

void add_map_command(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<MapArguments>();
  CLI::App* map = app.add_subcommand("map", "Look after map files");
  map->require_subcommand(1);
  add(*map, chosen, "list", "Say what is in it", list, arguments);
  add(*map, chosen, "check", "Look at every row", check, arguments);
  add(*map, chosen, "adjust", "Adjust the whole map once more (bundle adjustment)", adjust, arguments);
  add(*map, chosen, "merge", "Put the maps of other files into it; those that show a place of it become one with it",
      merge, arguments)
      ->add_option("OTHER", arguments->other_files, "map files")
      ->required();
  add(*map, chosen, "compact", "Give room back to the disk", compact, arguments);
  add(*map, chosen, "copy", "Copy it whole, also while a server writes it", copy, arguments)
      ->add_option("TO", arguments->folder, "file to write")
      ->required();
  add(*map, chosen, "export", "Write its paths and points as a result", export_map, arguments)
      ->add_option("DIR", arguments->folder, "folder to write")
      ->required();
}

}  // namespace coslam
