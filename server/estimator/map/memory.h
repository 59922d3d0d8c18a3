// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "server/estimator/map/map.h"

// Memory of a map in bytes, to see how fast it grows in a run.
namespace coslam {

using MemoryUse = std::map<std::string, std::size_t>;

template <class T>
std::size_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

// Returns the bytes by kind: poses, tracks (live ones), points, key_observations, patches, paths. Without the
// allocator's overhead.
MemoryUse memory_of(const Map& map);

}  // namespace coslam
