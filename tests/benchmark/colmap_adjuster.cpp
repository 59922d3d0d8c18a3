// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmark/colmap_adjuster.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace coslam::benchmarks {
namespace {

constexpr double kPixelCenter = 0.5;  // where COLMAP has the centre of its first pixel
constexpr int kDigits = 12;

std::ostream& operator<<(std::ostream& stream, const Eigen::Vector3d& v) {
  return stream << v.x() << ' ' << v.y() << ' ' << v.z();
}

void write_model(const BundleProblem& p, const std::filesystem::path& folder) {
  std::ofstream cameras(folder / "cameras.txt"), images(folder / "images.txt"), points(folder / "points3D.txt");
  for (auto* stream : {&cameras, &images, &points}) stream->precision(kDigits);
  for (std::size_t i = 0; i < p.cameras.size(); ++i) {
    const CameraModel& c = p.cameras[i];
    cameras << i + 1 << " PINHOLE " << c.width_px << ' ' << c.height_px << ' ' << c.fx << ' ' << c.fy << ' '
            << c.cx + kPixelCenter << ' ' << c.cy + kPixelCenter << '\n';
  }
  std::vector<std::ostringstream> seen(p.poses.size()), tracks(p.points.size());
  std::vector<int> seen_count(p.poses.size());
  for (const auto& o : p.observations) {
    const auto pose = static_cast<std::size_t>(o.pose), point = static_cast<std::size_t>(o.point);
    seen[pose].precision(kDigits);
    seen[pose] << o.undistorted_px.x() + kPixelCenter << ' ' << o.undistorted_px.y() + kPixelCenter << ' ' << point + 1
               << ' ';
    tracks[point] << ' ' << pose + 1 << ' ' << seen_count[pose]++;
  }
  for (std::size_t i = 0; i < p.poses.size(); ++i) {
    const Eigen::Quaterniond& q = p.poses[i].cam_from_world.rotation;
    images << i + 1 << ' ' << q.w() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << ' '
           << p.poses[i].cam_from_world.translation << ' ' << p.poses[i].camera + 1 << ' ' << i << ".png\n"
           << seen[i].str() << '\n';
  }
  for (std::size_t j = 0; j < p.points.size(); ++j)
    points << j + 1 << ' ' << p.points[j] << " 128 128 128 0" << tracks[j].str() << '\n';
}

// Rows of a table of COLMAP's, without its comments.
std::vector<std::string> rows_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw UserError(file.string() + ": cannot be read");
  std::vector<std::string> rows;
  for (std::string row; std::getline(stream, row);) {
    if (!row.starts_with('#')) rows.push_back(row);
  }
  return rows;
}

void read_model(const std::filesystem::path& folder, BundleProblem* p) {
  const auto images = rows_of(folder / "images.txt");
  for (std::size_t row = 0; row < images.size(); row += 2) {  // the other half are what each sees
    std::istringstream stream(images[row]);
    std::size_t id = 0;
    Eigen::Quaterniond q;
    Eigen::Vector3d t;
    stream >> id >> q.w() >> q.x() >> q.y() >> q.z() >> t.x() >> t.y() >> t.z();
    p->poses.at(id - 1).cam_from_world = Rigid3(q.normalized(), t);
  }
  for (const auto& row : rows_of(folder / "points3D.txt")) {
    std::istringstream stream(row);
    std::size_t id = 0;
    Eigen::Vector3d x;
    stream >> id >> x.x() >> x.y() >> x.z();
    p->points.at(id - 1) = x;
  }
}

// "Time : 1.234 [s]" in its summary.
double solver_s(const std::filesystem::path& log) {
  for (const auto& row : rows_of(log)) {
    const auto at = row.find("Time : ");
    if (at != std::string::npos) return std::stod(row.substr(at + 7));
  }
  throw UserError(log.string() + ": COLMAP tells no time");
}

}  // namespace

std::optional<ColmapAdjustment> adjust_by_colmap(const BundleProblem& problem, const BundleConfig& config) {
  if (std::system("command -v colmap > /dev/null") != 0) return std::nullopt;
  const test::TempFolder folder;
  const auto in = folder / "in", out = folder / "out", log = folder / "log";
  std::filesystem::create_directories(in);
  std::filesystem::create_directories(out);
  write_model(problem, in);
  // One thread: COLMAP takes all processors that it may run on.
  const std::string command = "taskset -c 0 colmap bundle_adjuster --input_path " + in.string() + " --output_path " +
                              out.string() +
                              " --BundleAdjustment.refine_focal_length 0 --BundleAdjustment.refine_extra_params 0" +
                              " --BundleAdjustment.max_num_iterations " + std::to_string(config.max_iterations) +
                              " --BundleAdjustment.function_tolerance " + std::to_string(config.function_tolerance) +
                              " > " + log.string() + " 2>&1 && colmap model_converter --input_path " + out.string() +
                              " --output_path " + out.string() + " --output_type TXT >> " + log.string() + " 2>&1";
  if (std::system(command.c_str()) != 0) throw UserError("colmap bundle_adjuster failed");
  ColmapAdjustment result{problem, solver_s(log)};
  read_model(out, &result.solved);
  return result;
}

}  // namespace coslam::benchmarks
