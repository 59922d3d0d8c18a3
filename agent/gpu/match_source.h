// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace coslam {

extern const char* const kMatchSource;  // match.cl

}  // namespace coslam
