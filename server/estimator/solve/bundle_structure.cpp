// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/bundle_structure.h"

#include <algorithm>
#include <utility>

namespace coslam {
namespace {

// Which links there are, and which of them each observation is part of.
void link_observations(const BundleProblem& problem, BundleStructure* s) {
  const std::size_t n = problem.observations.size();
  struct Part {
    int point, column;
    std::size_t observation;
    std::vector<int>* link_of;
  };
  std::vector<Part> parts;
  parts.reserve(problem.lenses.empty() ? n : (1 + BundleStructure::kHalves) * n);
  s->link_of.resize(n, -1);
  s->zoom_link_of.resize(n, -1);
  for (auto& of_half : s->lens_link_of) of_half.resize(n, -1);
  for (std::size_t i = 0; i < n; ++i) {
    const auto& o = problem.observations[i];
    const int column = s->column_of[at(o.pose)];
    const int lens = s->lens_column_of[at(problem.poses[at(o.pose)].camera)];
    if (column >= 0) parts.push_back({o.point, column, i, &s->link_of});
    for (int half = 0; lens >= 0 && half < BundleStructure::kHalves; ++half) {
      parts.push_back({o.point, lens + half, i, &s->lens_link_of[at(half)]});
    }
    if (const int zoom = s->zoom_of[at(o.pose)].column; zoom >= 0) {
      parts.push_back({o.point, zoom, i, &s->zoom_link_of});
    }
  }
  std::ranges::stable_sort(parts, {}, [](const Part& p) { return std::pair(p.point, p.column); });
  s->links_end.resize(problem.points.size());
  for (const Part& p : parts) {
    const bool again = !s->links.empty() && s->links.back().point == p.point && s->links.back().column == p.column;
    if (!again) s->links.push_back({p.column, p.point});
    (*p.link_of)[p.observation] = static_cast<int>(s->links.size()) - 1;
    s->links_end[at(p.point)] = static_cast<int>(s->links.size());
  }
}

// Six poses of one camera after the other share a column.
void place_zooms(const BundleProblem& problem, BundleStructure* s) {
  s->zoom_of.resize(problem.poses.size());
  std::vector<BundleStructure::ZoomPlace> last_of(problem.cameras.size(), {-1, BundleStructure::kZooms - 1});
  for (std::size_t i = 0; i < problem.zooms.size(); ++i) {
    if (!problem.zooms[i]) continue;
    BundleStructure::ZoomPlace& last = last_of[at(problem.poses[i].camera)];
    last = last.slot + 1 < BundleStructure::kZooms ? BundleStructure::ZoomPlace{last.column, last.slot + 1}
                                                   : BundleStructure::ZoomPlace{s->columns++, 0};
    s->zoom_of[i] = last;
  }
}

}  // namespace

BundleStructure structure_of(const BundleProblem& problem) {
  BundleStructure s;
  for (const auto& p : problem.poses) s.column_of.push_back(p.fixed ? -1 : s.columns++);
  s.lens_column_of.resize(problem.cameras.size(), -1);
  for (std::size_t i = 0; i < problem.lenses.size(); ++i) {
    if (problem.lenses[i].free) s.lens_column_of[i] = std::exchange(s.columns, s.columns + BundleStructure::kHalves);
  }
  place_zooms(problem, &s);
  link_observations(problem, &s);
  for (std::size_t p = 1; p < s.links_end.size(); ++p) s.links_end[p] = std::max(s.links_end[p], s.links_end[p - 1]);
  s.links_at.resize(at(s.columns));
  for (std::size_t l = 0; l < s.links.size(); ++l) s.links_at[at(s.links[l].column)].push_back(static_cast<int>(l));

  s.rows_at.resize(at(s.columns));
  for (const auto& t : problem.ties) {
    const auto [low, high] = std::minmax(s.column_of[at(t.first)], s.column_of[at(t.second)]);
    if (low >= 0 && low != high) s.rows_at[at(low)].push_back(high);
  }
  for (std::size_t i = 0; i < problem.zooms.size(); ++i) {
    const int before = problem.zooms[i] ? problem.zooms[i]->before : -1;
    if (before < 0) continue;
    const auto [low, high] = std::minmax(s.zoom_of[at(before)].column, s.zoom_of[i].column);
    if (low >= 0 && low != high) s.rows_at[at(low)].push_back(high);
  }
  std::vector<int> last_at(at(s.columns), -1);  // column at which a row was noted last
  for (int c = 0; c < s.columns; ++c) {
    auto& rows = s.rows_at[at(c)];
    std::vector<int> tied = std::exchange(rows, {c});
    last_at[at(c)] = c;
    const auto note = [&](int row) {
      if (std::exchange(last_at[at(row)], c) != c) rows.push_back(row);
    };
    for (const int row : tied) note(row);
    for (const int l : s.links_at[at(c)]) {
      for (int k = l + 1; k < s.links_end[at(s.links[at(l)].point)]; ++k) note(s.links[at(k)].column);
    }
    std::sort(rows.begin(), rows.end());
  }
  for (const auto& o : problem.observations) {
    const CameraModel& camera = problem.cameras[at(problem.poses[at(o.pose)].camera)];
    if (problem.lenses.empty()) {
      s.whiten.emplace_back(camera.raw_by_undistorted(o.undistorted_px) / o.sigma_px);
    } else {
      s.raw_px.push_back(camera.raw_from_undistorted(o.undistorted_px));
    }
  }
  return s;
}

}  // namespace coslam
