// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/wire/wire_config.h"

namespace coslam {

// The IPv4 addresses of this machine now.
std::vector<std::string> local_addresses();

// The local addresses by which others reach a participant with these settings; that of the loopback device where there
// is no other.
std::vector<std::string> addresses_used(const WireConfig& config);

}  // namespace coslam
