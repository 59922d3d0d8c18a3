// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/ids.h"
#include "common/model/image_account.h"

namespace coslam {

// The fates of one agent's images, as the server knows them.
struct AgentImages {
  std::string agent;
  RunId agent_run, server_run;
  ImageAccount images;
  bool complete = false;  // the agent has ended, and nothing of it is under way any more
  std::string problem;    // a sentence for the user about problems with these images; empty: no problem
};

}  // namespace coslam
