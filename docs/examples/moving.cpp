// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// moving RESULT: what moved through the picture, when, how far and how fast.
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.h"
#include "common/base/text.h"
#include "common/base/time.h"
#include "common/geometry/rigid3.h"

namespace {

using std::filesystem::path;
using Row = std::map<std::string, std::string, std::less<>>;  // field by name of its column

// Fields are found by the names in the first line, so a column that a later version adds does no harm.
void read_csv(const path& file, const std::function<void(const Row&)>& read_row) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) throw coslam::UserError(file.string() + ": cannot be read");
  std::vector<std::string> names;
  for (const std::string_view name : coslam::split_csv(line)) names.emplace_back(name);
  while (std::getline(stream, line)) {
    const std::vector<std::string_view> fields = coslam::split_csv(line);
    if (fields.size() != names.size()) throw coslam::UserError(file.string() + ": a line of another form: " + line);
    Row row;
    for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = fields[i];
    read_row(row);
  }
}

double number(const Row& row, const char* name) { return coslam::parse_double(row.at(name)).value_or(0); }

Eigen::Vector3d vector(const Row& row, const char* x, const char* y, const char* z) {
  return {number(row, x), number(row, y), number(row, z)};
}

// Points that move as one: a person, a cart, a car.
struct Track {
  double from_s = 0, to_s = 0;
  Eigen::Vector3d begin, end;  // of its path, in the common map frame
  double way = 0;              // along its path; a walk there and back has a way, but ends where it began
  std::vector<double> speeds;  // per second
  std::set<std::string, std::less<>> points;
};

void print_moving(const path& result) {
  // A line for each object at each instant at which it moves, in order of time.
  std::map<long, Track> objects;
  std::set<std::string, std::less<>> in_objects;
  read_csv(result / "objects.csv", [&](const Row& row) {
    const double t_s = number(row, "t_s");
    const Eigen::Vector3d place = vector(row, "x", "y", "z");
    const auto [at, is_new] = objects.try_emplace(coslam::parse_integer(row.at("object")).value_or(0));
    Track& track = at->second;
    if (is_new) {
      track.from_s = t_s;
      track.begin = track.end = place;
    }
    // The middle jumps whenever a point joins or leaves, and the velocity, which is that of the points, does not.
    track.speeds.push_back(vector(row, "vx", "vy", "vz").norm());
    if (!is_new) track.way += track.speeds.back() * (t_s - track.to_s);
    track.end = place;
    track.to_s = t_s;
    for (const std::string_view point : coslam::split_fields(row.at("members"))) track.points.emplace(point);
    in_objects.insert(track.points.begin(), track.points.end());
  });

  std::printf("%-8s %8s %8s %7s %9s %9s %9s\n", "object", "from s", "to s", "points", "way", "away", "speed");
  for (auto& [id, o] : objects) {
    const auto middle = o.speeds.begin() + static_cast<std::ptrdiff_t>(o.speeds.size() / 2);
    std::nth_element(o.speeds.begin(), middle, o.speeds.end());
    std::printf("%-8ld %8.2f %8.2f %7zu %9.3f %9.3f %9.3f\n", id, o.from_s, o.to_s, o.points.size(), o.way,
                (o.end - o.begin).norm(), *middle);
  }

  // A line for each moving point at each instant at which two cameras saw it; some points go alone.
  std::set<std::string, std::less<>> alone;
  std::size_t places = 0;
  read_csv(result / "dynamic.csv", [&](const Row& row) {
    ++places;
    if (!in_objects.contains(row.at("id"))) alone.insert(row.at("id"));
  });
  std::printf("%zu points in objects, %zu alone, %zu places in all\n", in_objects.size(), alone.size(), places);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: moving RESULT\n");
    return 2;
  }
  try {
    print_moving(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "moving: %s\n", error.what());
    return 1;
  }
}
