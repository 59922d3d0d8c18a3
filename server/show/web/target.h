// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace coslam {

// What a request asks for, its escapes decoded.
struct WebRequest {
  std::string path;  // from '/'
  std::map<std::string, std::string> query;
};

// Empty: not to be answered. It is no path from the top, climbs out of it, or has escapes or characters that no path
// of ours has.
std::optional<WebRequest> parse_target(std::string_view target);

}  // namespace coslam
