// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/trajectory.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "common/base/error.h"
#include "common/base/file_kind.h"
#include "common/base/text.h"
#include "common/dataset/file.h"

namespace coslam {
namespace {

// Empty when the fields are not a stamp and seven numbers with a unit quaternion.
std::optional<StampedPose> parse_pose(const std::vector<std::string_view>& fields) {
  if (fields.size() != 8) return std::nullopt;
  const auto t_ns = parse_seconds(fields[0]);
  if (!t_ns) return std::nullopt;
  std::array<double, 7> v{};
  for (std::size_t i = 0; i < 7; ++i) {
    const auto number = parse_double(fields[i + 1]);
    if (!number) return std::nullopt;
    v[i] = *number;
  }
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (std::abs(q.norm() - 1.0) > 0.01) return std::nullopt;  // truth files are written with few decimals
  const Rigid3 world_from_cam(q.normalized(), {v[0], v[1], v[2]});
  return StampedPose{*t_ns, world_from_cam.inverse()};
}

}  // namespace

Trajectory load_tum(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) {
    throw UserError(file.string() + ": cannot be read" + why_unreadable(file));
  }
  Trajectory trajectory;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto fields = split_fields(line);
    if (fields.empty() || fields[0].starts_with('#')) continue;
    const auto pose = parse_pose(fields);
    const std::string place = file.string() + ":" + std::to_string(number) + ": ";
    if (!pose) throw UserError(place + "not a line `t_s tx ty tz qx qy qz qw` with a unit quaternion");
    if (!trajectory.empty() && pose->t_ns <= trajectory.back().t_ns) {
      throw UserError(place + "the time is not later than that of the line before");
    }
    trajectory.push_back(*pose);
  }
  return trajectory;
}

void save_tum(const std::filesystem::path& file, const Trajectory& trajectory, LengthUnit unit) {
  OutputFile out(file, OutputFile::Shows::kWhole);
  out.write("# t_s tx ty tz qx qy qz qw, camera to world; " + std::string(words_of(unit)) + "\n");
  for (const StampedPose& pose : trajectory) {
    const Rigid3 w = pose.cam_from_world.inverse();
    char text[256];
    std::snprintf(text, sizeof text, " %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", w.translation.x(), w.translation.y(),
                  w.translation.z(), w.rotation.x(), w.rotation.y(), w.rotation.z(), w.rotation.w());
    out.write(format_seconds(pose.t_ns) + text);
  }
  out.close();
}

std::optional<Rigid3> pose_at(const Trajectory& trajectory, TimeNs t_ns, TimeNs max_gap_ns) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), t_ns,
                                      [](const StampedPose& p, TimeNs t) { return p.t_ns < t; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->t_ns == t_ns) return after->cam_from_world;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const TimeNs gap_ns = after->t_ns - before->t_ns;
  if (gap_ns > max_gap_ns) return std::nullopt;
  const double s = static_cast<double>(t_ns - before->t_ns) / static_cast<double>(gap_ns);
  // The centre moves straight in the world; cam_from_world's translation does not.
  return interpolate(before->cam_from_world.inverse(), after->cam_from_world.inverse(), s).inverse();
}

}  // namespace coslam
