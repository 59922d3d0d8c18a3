// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "agent/track/cell_corners.h"
#include "agent/track/key_patch.h"
#include "agent/track/matcher.h"
#include "agent/track/samples.h"

namespace coslam {

// Values that kernels take and give, by the octets of their namesakes in program/values.cl: Size, Sought, Key,
// Sighting, Limits, Cell, Corner and CellCorners.
struct DeviceSize {
  std::int32_t offset, cols, rows, stride;
};
struct DeviceSought {
  std::array<float, 2> from, motion;
  std::array<float, 4> warp;
  std::int32_t moving, key;
};
struct DeviceKey {
  std::array<std::int16_t, kWindowArea> grey, dx, dy;
  float squares;
  std::array<float, 7> totals;
  std::array<float, 49> inverse;
};
struct DeviceSighting {
  std::int32_t found;
  std::array<float, 2> px;
  std::int32_t key_found;
  std::array<float, 2> key_px;
  float key_zncc;
  std::array<float, 4> key_warp;
};
struct DeviceLimits {
  float min_zncc, forward_backward_px, border_px;
};
struct DeviceCell {
  std::int32_t x0, y0, x1, y1;
};
struct DeviceCorner {
  float x, y, score;
};
struct DeviceCellCorners {
  float mean_score;
  std::int32_t count;
  std::array<DeviceCorner, kMostCellCorners> corners;  // strongest first
};

// Track for the kernels; `key` is the place of its first patch in the device's memory.
DeviceSought device_sought(const Sought& t, std::int32_t key);

// First patch for the kernels.
DeviceKey device_key(const KeyPatch& k);

// Limits of the checks for the kernels.
DeviceLimits device_limits(const TrackerConfig& config);

// Sighting that a kernel gave.
TrackSighting track_sighting(const DeviceSighting& s);

// Corners that a kernel gave, strongest last.
CellCorners cell_corners(const DeviceCellCorners& found);

}  // namespace coslam
