// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/robust.h"

#include <algorithm>
#include <cmath>

namespace coslam {

double tukey_rho(double x, double t) {
  const double full = t * t / 6.0;
  if (std::abs(x) > t) return full;
  const double u = 1.0 - (x / t) * (x / t);
  return full * (1.0 - u * u * u);
}

double tukey_weight(double x, double t) {
  if (std::abs(x) > t) return 0.0;
  const double u = 1.0 - (x / t) * (x / t);
  return u * u;
}

double upper_median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double robust_sigma_2d(std::vector<double>& norms) {
  return upper_median(norms) / std::sqrt(2.0 * std::log(2.0));  // median of the Rayleigh distribution
}

}  // namespace coslam
