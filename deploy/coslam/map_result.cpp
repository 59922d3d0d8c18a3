// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/map_result.h"

#include <string>

#include "common/base/error.h"
#include "server/estimator/map/validate.h"
#include "server/keep/observe/result_store.h"
#include "server/keep/report.h"

namespace coslam {
MapServer load_map(const MapFile& file) {
  MapServer server(RunId(1), {});
  server.restore(file.read(), 0, file.version());
  return server;
}

void write_map_result(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const MapFile file(path, MapFile::Access::kRead);
  MapServer server = load_map(file);
  server.meet_all();
  if (ResultFolder(folder).holds_run()) throw UserError(folder.string() + " holds a run: choose another");
  ResultStore result(folder);
  PastPart past;
  file.for_each_row(kPastFramesTable, 0, kLastRow, [&](const std::string& octets) {
    past.frames = {past_frames_of(octets)};
    validate(past.frames.front(), server.map());
    result.take(past);
  });
  past.frames.clear();
  file.for_each_row(kPastPlacesTable, 0, kLastRow, [&](const std::string& octets) {
    past.places = past_places_of(octets);
    validate(*past.places, server.map());
    result.take(past);
  });
  auto report = make_map_report(server);
  report["map_file"] = file.path().filename().string();
  result.finish(server, report);
}

}  // namespace coslam
