// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/wire/wire_config.h"

namespace coslam {

// Listens in the domain for two seconds from when somebody is heard and tells who is there. Throws UserError when
// nobody is heard for three.
std::string listen_for_status(const WireConfig& config);

}  // namespace coslam
