// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/moving.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <opencv2/core.hpp>

#include "common/base/error.h"
#include "common/base/text.h"
#include "common/image/image_file.h"
#include "deploy/coslam/eval/statistics.h"

namespace coslam::eval {
namespace {

std::optional<double> ratio(int part, int whole) {
  return whole == 0 ? std::nullopt : std::optional(static_cast<double>(part) / whole);
}

constexpr TimeNs kMaxGap_ns = 200'000'000;  // of marked points

std::vector<double> distances_between(const PointPath& estimate, const PointPath& truth,
                                      const Similarity3& truth_from_map) {
  std::vector<double> distances;
  for (const StampedPosition& sample : estimate) {
    if (const auto marked = position_at(truth, sample.t_ns, kMaxGap_ns)) {
      distances.push_back((truth_from_map * sample.position - *marked).norm());
    }
  }
  return distances;
}

}  // namespace

std::optional<bool> Masks::moving_at(const std::string& agent, FrameId frame, const Eigen::Vector2d& raw_px) {
  char name[32];
  std::snprintf(name, sizeof name, "%06u.png", frame.value);
  if (const auto file = folder_ / agent / name; file != file_) {
    file_ = file;
    mask_ = decode_grey(read_octets(file));
  }
  const int x = static_cast<int>(std::lround(raw_px.x())), y = static_cast<int>(std::lround(raw_px.y()));
  if (mask_.empty() || x < 0 || y < 0 || x >= mask_.cols || y >= mask_.rows) return std::nullopt;
  constexpr int kMargin_px = 2;
  const cv::Rect around(x - kMargin_px, y - kMargin_px, 2 * kMargin_px + 1, 2 * kMargin_px + 1);
  const cv::Mat patch = mask_(around & cv::Rect(0, 0, mask_.cols, mask_.rows));
  const int moving = cv::countNonZero(patch);
  if (moving != 0 && moving != static_cast<int>(patch.total())) return std::nullopt;
  return moving != 0;
}

void Classification::add(bool moving, std::optional<PointState> state) {
  const bool dynamic = state == PointState::kDynamic;
  if (moving) ++(dynamic ? dynamic_moving_ : other_moving_);
  if (!moving) ++(dynamic ? dynamic_still_ : other_still_);
  if (moving && state == PointState::kStatic) ++static_moving_;
}

std::optional<double> Classification::precision() const {
  return ratio(dynamic_moving_, dynamic_moving_ + dynamic_still_);
}
std::optional<double> Classification::recall() const { return ratio(dynamic_moving_, dynamic_moving_ + other_moving_); }
std::optional<double> Classification::static_on_moving() const {
  return ratio(static_moving_, dynamic_moving_ + other_moving_);
}

std::optional<double> Classification::false_alarm() const {
  return ratio(dynamic_still_, dynamic_still_ + other_still_);
}

std::optional<double> median_length_s(const std::unordered_map<PointId, PointPath>& paths) {
  std::vector<double> lengths_s;
  for (const auto& [id, path] : paths) {
    if (path.size() >= 2) lengths_s.push_back(to_seconds(path.back().t_ns - path.front().t_ns));
  }
  return lengths_s.empty() ? std::nullopt : std::optional(percentile(std::move(lengths_s), 50));
}

std::optional<Eigen::Vector3d> position_at(const PointPath& path, TimeNs t_ns, TimeNs max_gap_ns) {
  const auto after =
      std::lower_bound(path.begin(), path.end(), t_ns, [](const StampedPosition& p, TimeNs t) { return p.t_ns < t; });
  if (after == path.end()) return std::nullopt;
  if (after->t_ns == t_ns) return after->position;
  if (after == path.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const TimeNs gap_ns = after->t_ns - before->t_ns;
  if (gap_ns > max_gap_ns) return std::nullopt;
  const double s = static_cast<double>(t_ns - before->t_ns) / static_cast<double>(gap_ns);
  return (1 - s) * before->position + s * after->position;
}

std::unordered_map<PointId, PointPath> read_dynamic(const std::filesystem::path& file) {
  std::unordered_map<PointId, PointPath> paths;
  for_each_dynamic_row(file, [&](const ResultDynamicRow& r) { paths[r.id].push_back({r.t_ns, r.position}); });
  for (auto& [id, path] : paths) {
    std::stable_sort(path.begin(), path.end(), [](const auto& a, const auto& b) { return a.t_ns < b.t_ns; });
  }
  return paths;
}

std::map<std::string, PointPath> read_truth_points(const std::filesystem::path& file, TimeNs later_ns) {
  std::ifstream stream(file);
  if (!stream) throw UserError(file.string() + ": cannot be read");
  std::map<std::string, PointPath> paths;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#' || text == "t_s,id,x,y,z") continue;
    const auto fields = split_csv(text);
    const auto t_ns = fields.size() == 5 ? parse_seconds(fields[0]) : std::nullopt;
    const auto number_at = [&](std::size_t i) { return fields.size() == 5 ? parse_double(fields[i]) : std::nullopt; };
    const auto x = number_at(2), y = number_at(3), z = number_at(4);
    if (!t_ns || !x || !y || !z) {
      throw UserError(file.string() + ":" + std::to_string(number) + ": not a line `t_s,id,x,y,z`");
    }
    paths[std::string(fields[1])].push_back({*t_ns - later_ns, {*x, *y, *z}});
  }
  for (auto& [id, path] : paths) {
    std::stable_sort(path.begin(), path.end(), [](const auto& a, const auto& b) { return a.t_ns < b.t_ns; });
  }
  return paths;
}

DynamicErrors dynamic_errors(const std::unordered_map<PointId, PointPath>& estimate,
                             const std::map<std::string, PointPath>& truth, const Similarity3& truth_from_map,
                             double max_distance_m) {
  DynamicErrors result;
  for (const auto& [id, path] : estimate) {
    std::vector<double> nearest;
    double nearest_median = max_distance_m;
    for (const auto& [marked_id, marked] : truth) {
      auto distances = distances_between(path, marked, truth_from_map);
      if (distances.empty()) continue;
      const double median = percentile(distances, 50);
      if (median > nearest_median) continue;
      nearest_median = median;
      nearest = std::move(distances);
    }
    ++(nearest.empty() ? result.unmatched_paths : result.paths);
    result.errors_m.insert(result.errors_m.end(), nearest.begin(), nearest.end());
  }
  return result;
}

}  // namespace coslam::eval
