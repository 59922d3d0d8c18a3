// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// paths RESULT: for each agent how much of its images has a pose, and how long and how fast its path is.
#include <cstddef>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>  // the package depends on it
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.h"
#include "common/base/text.h"
#include "common/base/time.h"
#include "common/geometry/rigid3.h"

namespace {

using std::filesystem::path;

// A transform is named for what it does: world_from_cam takes coordinates in the camera to coordinates in the world.
struct Pose {
  coslam::TimeNs t_ns = 0;
  coslam::Rigid3 world_from_cam;
};

// Reads lines `t_s tx ty tz qx qy qz qw`, camera to world; those that begin with # are comments.
std::vector<Pose> read_tum(const path& file) {
  std::vector<Pose> poses;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with('#')) continue;
    const std::vector<std::string_view> fields = coslam::split_fields(line);
    const auto t_ns = fields.size() == 8 ? coslam::parse_seconds(fields[0]) : std::nullopt;
    std::vector<double> numbers;
    for (std::size_t i = 1; i < fields.size(); ++i) {
      if (const auto number = coslam::parse_double(fields[i])) numbers.push_back(*number);
    }
    if (!t_ns || numbers.size() != 7) throw coslam::UserError(file.string() + ": not a line of poses: " + line);
    const Eigen::Quaterniond rotation(numbers[6], numbers[3], numbers[4], numbers[5]);  // Eigen begins with w
    poses.push_back({*t_ns, {rotation.normalized(), {numbers[0], numbers[1], numbers[2]}}});
  }
  return poses;
}

// Where an agent had no pose for a while, the straight line across the gap counts.
double length_of(const std::vector<Pose>& poses) {
  double length = 0;
  for (std::size_t i = 1; i < poses.size(); ++i)
    length += (poses[i].world_from_cam.translation - poses[i - 1].world_from_cam.translation).norm();
  return length;
}

void print_paths(const path& result) {
  std::ifstream stream(result / "report.json");
  if (!stream) throw coslam::UserError(result.string() + ": there is no report.json, so this is no result");
  const nlohmann::json report = nlohmann::json::parse(stream);

  // The common map comes first. Others, which could not be brought together with it, have folders in maps/.
  if (report.at("maps").empty()) throw coslam::UserError(result.string() + ": nothing was mapped");
  const bool in_metres = report["maps"][0].at("scale_known");
  const char* unit = in_metres ? "m" : "units";

  std::printf("%-12s %7s %8s %14s %16s\n", "agent", "images", "tracked", "path", "mean speed");
  for (const auto& [name, agent] : report.at("agents").items()) {
    // Each image that its source gave has one fate, also those that never reached the server.
    const long images = agent.at("images").at("captured");
    const double tracked_percent = agent.at("tracked_percent");
    // An agent that is not in the common map has no file here.
    const std::vector<Pose> poses = read_tum(result / "trajectory" / (name + ".tum"));
    const double length = length_of(poses);
    const double seconds = poses.empty() ? 0 : coslam::to_seconds(poses.back().t_ns - poses.front().t_ns);
    std::printf("%-12s %7ld %7.1f%% %8.3f %-5s %8.3f %s/s\n", name.c_str(), images, tracked_percent, length, unit,
                seconds > 0 ? length / seconds : 0.0, unit);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: paths RESULT\n");
    return 2;
  }
  try {
    print_paths(argv[1]);
  } catch (const std::exception& error) {  // UserError is one, and so is what the reader of JSON throws
    std::fprintf(stderr, "paths: %s\n", error.what());
    return 1;
  }
}
