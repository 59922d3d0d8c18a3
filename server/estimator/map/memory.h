// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "server/estimator/map/map.h"

// What a map holds, in bytes: of what grows with a run somebody should know how fast.
namespace coslam {

using MemoryUse = std::map<std::string, std::size_t>;

template <class T>
std::size_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

// By what it is kept for: poses, tracks (live ones), points, key_observations, patches, paths. Without what the
// allocator adds.
MemoryUse memory_of(const Map& map);

}  // namespace coslam
