// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace coslam {

// Lets the calling thread run only when others do not need the processor: when it wakes up, it does not preempt them.
// Without effect where the system does not allow it.
void give_way();

}  // namespace coslam
