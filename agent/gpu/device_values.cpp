// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/device_values.h"

#include <algorithm>
#include <cstddef>

namespace coslam {
namespace {

template <class To, class From>
To copied(const From& from) {
  To to{};
  std::copy_n(from.data(), to.size(), to.begin());
  return to;
}

}  // namespace

DeviceSought device_sought(const Sought& t, std::int32_t key) {
  const Eigen::Matrix2f& w = t.key->warp;
  return {copied<std::array<float, 2>>(t.from_px),
          copied<std::array<float, 2>>(t.motion_px),
          {w(0, 0), w(0, 1), w(1, 0), w(1, 1)},
          t.moving,
          key};
}

DeviceKey device_key(const KeyPatch& k) {
  using Grey = std::array<std::int16_t, kWindowArea>;
  return {copied<Grey>(k.grey),
          copied<Grey>(k.dx),
          copied<Grey>(k.dy),
          k.squares,
          copied<std::array<float, 7>>(k.totals),
          copied<std::array<float, 49>>(k.inverse)};
}

DeviceLimits device_limits(const TrackerConfig& config) {
  return {static_cast<float>(config.min_zncc), static_cast<float>(config.forward_backward_px),
          static_cast<float>(config.border_px)};
}

TrackSighting track_sighting(const DeviceSighting& s) {
  TrackSighting out;
  if (s.found == 0) return out;
  out.found = true;
  out.px = {s.px[0], s.px[1]};
  if (s.key_found == 0) return out;
  out.key.found = true;
  out.key.px = {s.key_px[0], s.key_px[1]};
  out.key.zncc = s.key_zncc;
  out.key.warp << s.key_warp[0], s.key_warp[1], s.key_warp[2], s.key_warp[3];
  return out;
}

CellCorners cell_corners(const DeviceCellCorners& found) {
  CellCorners out{{}, found.mean_score};
  for (std::int32_t i = found.count - 1; i >= 0; --i) {
    const DeviceCorner& c = found.corners.at(static_cast<std::size_t>(i));
    out.corners.push_back({{c.x, c.y}, c.score});
  }
  return out;
}

}  // namespace coslam
