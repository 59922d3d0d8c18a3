// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/wire/wire_config.h"
#include "server/link/server_link.h"

namespace coslam {

// Opens the link over DDS. Throws UserError when the network, domain or certificates of `config` cannot be used.
std::unique_ptr<ServerLink> open_server_link(const WireConfig& config, RunId server_run);

}  // namespace coslam
