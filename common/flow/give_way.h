// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace coslam {

// From now on the calling thread runs when others do not need the processor: woken by one of them, it does not take its
// place. Where the system does not allow it everything stays as it was.
void give_way();

}  // namespace coslam
