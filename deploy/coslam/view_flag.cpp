// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/view_flag.h"

namespace coslam {

void add_view_flag(CLI::App& command, std::string& port) {
  const std::string usual = "8765";  // where Foxglove looks first
  // A flag that may have a value: an option would take the next argument for its own.
  command
      .add_flag("--view{" + usual + "}", port,
                "show it on the web, --view=PORT on another port than " + usual + "; 0: a free one")
      ->check(CLI::Range(0, 65535));
}

}  // namespace coslam
