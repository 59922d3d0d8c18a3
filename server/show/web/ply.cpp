// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/ply.h"

#include <algorithm>
#include <cstring>

namespace coslam {
namespace {

template <class T>
void put(std::string& out, T value) {
  char octets[sizeof value];
  std::memcpy(octets, &value, sizeof value);
  out.append(octets, sizeof value);
}

}  // namespace

std::string ply_of(const PublicCloud& cloud) {
  const auto shown = [&](const ros::StaticPoint& p) { return !p.on_trial && p.map == cloud.main; };
  const auto count = std::ranges::count_if(cloud.points, shown);
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(count) +
                    "\nproperty float x\nproperty float y\nproperty float z\nproperty float sqrt_trace_sigma\n"
                    "property uint id\nend_header\n";
  for (const ros::StaticPoint& p : cloud.points) {
    if (!shown(p)) continue;
    for (const float v : {p.position.x(), p.position.y(), p.position.z(), p.sigma}) put(out, v);
    put(out, p.id.value);
  }
  return out;
}

}  // namespace coslam
