// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/result_rows.h"

#include <algorithm>

#include "server/estimator/map/sighting.h"

namespace coslam {
namespace {

constexpr double kBeside_s = 0.25, kMinSpan_s = 0.2, kThin_s = 5;

std::array<std::uint8_t, 3> rgb_of(const MapPoint& p) {
  const std::uint8_t grey = p.patches.empty() ? 128 : p.patches.front().pixels[kPatchBytes / 2];
  return {grey, grey, grey};
}

}  // namespace

std::vector<ResultPoint> result_points(const Map& map, MapId map_id) {
  std::vector<ResultPoint> out;
  for (const auto& [id, p] : map.points()) {
    if (p.map != map_id) continue;
    out.push_back({id, p.position, p.covariance, told_state(p.phase), p.first_ns, p.last_ns, static_cast<int>(p.views),
                   rgb_of(p)});
  }
  return out;
}

std::vector<ResultDynamicRow> moving_rows(const Map& map, MapId map_id) {
  std::vector<ResultDynamicRow> rows;
  for (const auto& [id, path] : map.motions()) {
    for (const MotionSample& sample : path) {
      const auto seen = position_of(map, map_id, sample);
      if (seen) rows.push_back({sample.t_ns, id, seen->at.position, seen->at.covariance, seen->views});
    }
  }
  std::ranges::stable_sort(rows, {}, &ResultDynamicRow::t_ns);
  return rows;
}

void ObjectRows::add(const ResultDynamicRow& row) {
  newest_ns_ = row.t_ns;
  paths_[row.id].push_back({SetId(), row.t_ns, row.position});
  write_until(newest_ns_ - to_ns(kBeside_s) - 1);
}

void ObjectRows::add(const std::vector<SeenObject>& objects) {
  waiting_.insert(waiting_.end(), objects.begin(), objects.end());
  if (!objects.empty()) known_until_ns_ = objects.back().t_ns;
}

void ObjectRows::finish() { write_until(std::numeric_limits<TimeNs>::max()); }

void ObjectRows::write_until(TimeNs t_ns) {
  for (; !waiting_.empty() && waiting_.front().t_ns <= t_ns; waiting_.pop_front()) write(waiting_.front());
  if (newest_ns_ < thinned_ns_ + to_ns(kThin_s)) return;
  thinned_ns_ = newest_ns_;
  const TimeNs oldest_ns =
      (waiting_.empty() ? newest_ns_ : std::min(newest_ns_, waiting_.front().t_ns)) - to_ns(kThin_s);
  for (auto& [id, path] : paths_) std::erase_if(path, [&](const PathSample& p) { return p.t_ns < oldest_ns; });
  std::erase_if(paths_, [](const auto& path) { return path.second.empty(); });
}

void ObjectRows::write(const SeenObject& o) {
  std::vector<PointMotion> motions;
  ResultObjectRow row{.t_ns = o.t_ns, .object = o.id};
  for (const PointId id : o.members) {
    const auto path = paths_.find(id);
    if (path == paths_.end()) continue;
    const auto motion =
        motion_at(path->second, o.t_ns, o.t_ns - to_ns(kBeside_s), o.t_ns + to_ns(kBeside_s), kMinSpan_s);
    if (!motion) continue;
    motions.push_back(*motion);
    row.members.push_back(id);
  }
  if (motions.empty()) return;
  const BodyMotion body = body_of(motions);
  row.position = body.centroid;
  row.velocity_per_s = body.velocity;
  row.extent = body.extent;
  writer_.write(row);
}

}  // namespace coslam
