// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace coslam::eval {

// Linear between the ranks; 0 when empty.
double percentile(std::vector<double> values, double percent);
double root_mean_square(const std::vector<double>& values);

}  // namespace coslam::eval
