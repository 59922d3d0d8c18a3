// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "common/wire/wire_config.h"

namespace coslam {

struct StatusOptions {
  bool json = false;
  bool watch = false;  // again each second, until stopped
};

// Listens in the domain for two seconds from when somebody is heard and tells who is there. Throws UserError when
// nobody is heard for three.
void listen_for_status(const WireConfig& config, const StatusOptions& options,
                       const std::function<void(const std::string&)>& tell);

}  // namespace coslam
