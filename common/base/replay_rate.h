// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace coslam {

// Parses the value of --rate: a factor of real time, at most 1000; 0 for "max", as fast as the server answers. Throws
// UsageError.
double parse_replay_rate(const std::string& text);

}  // namespace coslam
