// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/wire/wire_config.h"

// The DDS domain of ROS 2 nodes.
namespace coslam {

// The domain in the variable ROS_DOMAIN_ID; empty: it is not set. Throws UserError: no number of a domain.
std::optional<int> ros_domain_id();

// Settings to join the domain of ROS 2 nodes on these addresses of this host; none: on all.
WireConfig ros_wire(int domain, const std::vector<std::string>& interfaces = {"127.0.0.1"});

}  // namespace coslam
