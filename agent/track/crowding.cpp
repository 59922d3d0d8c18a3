// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/track/crowding.h"

#include <algorithm>
#include <array>

namespace coslam {

std::vector<std::size_t> crowded_tracks(const std::vector<Track>& tracks, int image_cols, int image_rows, int count) {
  constexpr int kColumns = 10, kRows = 8;
  std::array<std::vector<std::size_t>, kColumns * kRows> cells;  // ascending age of ids, so the newest is last
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const int x = static_cast<int>(tracks[i].raw_px.x()) * kColumns / image_cols;
    const int y = static_cast<int>(tracks[i].raw_px.y()) * kRows / image_rows;
    cells[static_cast<std::size_t>(std::clamp(y, 0, kRows - 1) * kColumns + std::clamp(x, 0, kColumns - 1))].push_back(
        i);
  }
  std::vector<std::size_t> crowded;
  for (int n = 0; n < count; ++n) {
    auto fullest =
        std::max_element(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    crowded.push_back(fullest->back());
    fullest->pop_back();
  }
  std::sort(crowded.rbegin(), crowded.rend());
  return crowded;
}

}  // namespace coslam
