// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/agent_link.h"

#include "common/base/error.h"
#include "common/wire/codec.h"

namespace coslam {

void require_valid(const Hello& hello) {
  if (!valid_agent_name(hello.agent)) {
    throw UserError("agent name '" + hello.agent +
                    "' is not valid: use 1 to 32 letters, digits, '_', '-' or '.', and no '.' in front");
  }
  if (const auto problem = problem_of(hello.camera)) {
    throw UserError("calibration of agent '" + hello.agent + "': " + *problem);
  }
  auto decoded = decode(encode(hello));
  if (!decoded)
    throw UserError("agent '" + hello.agent + "' cannot be announced: " + std::string(name_of(decoded.rejection())));
}

}  // namespace coslam
