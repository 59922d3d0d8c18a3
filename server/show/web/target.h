// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace coslam {

// Path and query of a request, escapes decoded.
struct WebRequest {
  std::string path;  // begins with '/'
  std::map<std::string, std::string> query;
};

// Parses a target; empty: it must not be answered, because it is no path from the top, climbs out of it, or has escapes
// or characters that no path of ours has.
std::optional<WebRequest> parse_target(std::string_view target);

}  // namespace coslam
