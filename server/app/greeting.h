// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/wire/wire_config.h"

namespace coslam {

// What a server says when it is ready: where it is, where its results go, and how an agent joins it.
struct Greeting {
  std::string here;   // continues "map server in "
  std::string agent;  // a command line
};

// addresses: by which others reach it. results: the folder of the runs or of the run; empty: none are kept.
Greeting greeting(const WireConfig& wire, const std::vector<std::string>& addresses, const std::string& results);

}  // namespace coslam
