// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/ids.h"

namespace coslam {

// Draws the id of a process that begins: no other has it.
RunId draw_run_id();

}  // namespace coslam
