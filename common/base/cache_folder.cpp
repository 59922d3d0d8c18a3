// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/cache_folder.h"

#include <cstdlib>

namespace coslam {

std::optional<std::filesystem::path> cache_folder() {
  if (const char* set = std::getenv("COSLAM_CACHE"); set != nullptr && *set != '\0') return set;
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::filesystem::path(home) / ".cache/coslam";
  return std::nullopt;
}

}  // namespace coslam
