// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/wire/address_watch.h"
#include "common/wire/addresses.h"
#include "common/wire/participant.h"
#include "common/wire/wire_config.h"
#include "server/fleet/link/server_link.h"

namespace coslam {

// Opens the link over DDS. Throws UserError when the network, domain or certificates of `config` cannot be used.
// `addresses`: of this machine, looked at from time to time; when they change the link joins the domain anew as the
// same run, and agents go on.
std::unique_ptr<ServerLink> open_server_link(const WireConfig& config, RunId server_run,
                                             const AddressWatch::Addresses& addresses = local_addresses);

}  // namespace coslam
