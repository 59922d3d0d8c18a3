// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <functional>

#include "common/base/error.h"
#include "common/base/printed.h"
#include "common/dataset/file.h"
#include "common/dataset/trajectory.h"
#include "deploy/coslam/export/export.h"

namespace coslam::exporting {
namespace {

using PoseText = std::function<std::string(const StampedPose&)>;

const std::vector<std::string>& agents_of(const ResultMap& map) {
  if (map.agents.empty())
    throw UserError(map.folder.path().string() +
                    ": there is no trajectory/<agent>.tum in it; what a killed server had, only --map FILE keeps");
  return map.agents;
}

// A line for each pose of each agent.
Files export_lines(const ResultMap& map, const std::filesystem::path& folder, const std::string& extension,
                   const std::string& header, const PoseText& pose_text) {
  Files files;
  for (const std::string& agent : agents_of(map)) {
    files.push_back(folder / (agent + extension));
    std::ofstream stream = create_file(files.back());
    stream << header;
    for (const StampedPose& pose : load_tum(map.folder.trajectory(agent))) stream << pose_text(pose);
    close_file(stream, files.back());
  }
  return files;
}

std::string euroc_text(const StampedPose& pose) {
  const Rigid3 w = pose.cam_from_world.inverse();
  const auto& [t, q] = std::pair(w.translation, w.rotation);
  char text[256];
  std::snprintf(text, sizeof text, "%lld,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f\n", static_cast<long long>(pose.t_ns),
                t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z());
  return text;
}

std::string kitti_text(const StampedPose& pose) {
  const auto m = pose.cam_from_world.inverse().matrix();
  std::string line;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      char number[32];
      std::snprintf(number, sizeof number, "%s%.9e", line.empty() ? "" : " ", m(row, column));
      line += number;
    }
  }
  return line + "\n";
}

}  // namespace

Files export_tum(const ResultMap& map, const std::filesystem::path& folder) {
  Files files;
  for (const std::string& agent : agents_of(map)) {
    files.push_back(folder / (agent + ".tum"));
    save_tum(files.back(), load_tum(map.folder.trajectory(agent)), map.unit);
  }
  return files;
}

Files export_euroc(const ResultMap& map, const std::filesystem::path& folder) {
  const std::string unit = map.unit == LengthUnit::kMapUnits ? " [map units, scale unknown]" : " [m]";
  return export_lines(map, folder, ".csv",
                      "#timestamp [ns],p_x" + unit + ",p_y" + unit + ",p_z" + unit + ",q_w [],q_x [],q_y [],q_z []\n",
                      euroc_text);
}

Files export_kitti(const ResultMap& map, const std::filesystem::path& folder) {
  Files files = export_lines(map, folder, ".txt", "", kitti_text);
  const Files times = export_lines(map, folder, ".times.txt", "",
                                   [](const StampedPose& pose) { return printed("%.9f\n", to_seconds(pose.t_ns)); });
  files.insert(files.end(), times.begin(), times.end());
  return files;
}

std::string gaps_of(const ResultMap& map) {
  constexpr double kGap = 1.5;  // of the usual time between two poses
  std::string out;
  for (const std::string& agent : map.agents) {
    const Trajectory path = load_tum(map.folder.trajectory(agent));
    std::vector<TimeNs> steps_ns;
    for (std::size_t i = 1; i < path.size(); ++i) steps_ns.push_back(path[i].t_ns - path[i - 1].t_ns);
    if (steps_ns.empty()) continue;
    std::vector<TimeNs> sorted = steps_ns;
    std::ranges::nth_element(sorted, sorted.begin() + std::ssize(sorted) / 2);
    const double usual_s = to_seconds(sorted[sorted.size() / 2]);
    const auto longest = std::ranges::max_element(steps_ns);
    const auto gaps = std::ranges::count_if(steps_ns, [&](TimeNs step) { return to_seconds(step) > kGap * usual_s; });
    if (gaps == 0) continue;
    const auto at = static_cast<std::size_t>(longest - steps_ns.begin());
    out += printed("%s%s has no pose at %ld %s, the longest of %.2f s after %.2f s", out.empty() ? "" : "; ",
                   agent.c_str(), static_cast<long>(gaps), gaps == 1 ? "place" : "places", to_seconds(*longest),
                   to_seconds(path[at].t_ns));
  }
  return out;
}

Files export_maps(const ResultContents& contents, const std::filesystem::path& folder, const MapExport& export_map) {
  Files files;
  for (std::size_t i = 0; i < contents.maps.size(); ++i) {
    const ResultMap& map = contents.maps[i];
    const Files more = export_map(map, i == 0 ? folder : folder / "maps" / std::to_string(map.id.value));
    files.insert(files.end(), more.begin(), more.end());
  }
  return files;
}

}  // namespace coslam::exporting
