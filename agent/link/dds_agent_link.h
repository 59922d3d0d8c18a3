// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "agent/link/agent_link.h"
#include "common/wire/address_watch.h"
#include "common/wire/addresses.h"
#include "common/wire/participant.h"
#include "common/wire/wire_config.h"

namespace coslam {

// Opens the link over DDS and announces the agent. Throws UserError when the network, domain or certificates of
// `config` cannot be used. A refusal by the server comes later, see refusal_of() in common/model/session.h.
// When this machine's addresses change (another access point, a new lease) it joins the domain anew by itself, as the
// same run: the middleware goes by those that it found at its start.
std::unique_ptr<AgentLink> open_agent_link(const WireConfig& config, const Hello& hello,
                                           const AddressWatch::Addresses& addresses = local_addresses);

}  // namespace coslam
