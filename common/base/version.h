// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace coslam {

// Version of the product, as in "0.1.0".
const char* version();

}  // namespace coslam
