// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/wire/wire_config.h"

namespace coslam {

// Text of a server that is ready: where it is, where its results go, and how an agent joins it.
struct Greeting {
  std::string place;  // continues "map server in "
  std::string agent;  // a command line
};

// Makes the greeting; addresses: by which others reach the server. results: the folder of the runs or of the run;
// empty: none are kept.
Greeting greeting(const WireConfig& wire, const std::vector<std::string>& addresses, const std::string& results);

}  // namespace coslam
