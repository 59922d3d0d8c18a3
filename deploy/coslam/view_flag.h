// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace coslam {

// --view[=PORT]: where the command shows its map on the web; stays empty where it is not given.
void add_view_flag(CLI::App& command, std::string& port);

}  // namespace coslam
