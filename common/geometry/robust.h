// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace coslam {

// Extent of the Tukey bi-weight for the norm of two coordinates, in standard deviations of one: 3 of one axis.
inline constexpr double kTukeyOfTwo = 3.0 * 1.2;
// Standard deviations beyond which an observation counts less in adjustments of points and poses together (Cauchy).
inline constexpr double kCauchySigmas = 2.0;

// Tukey bi-weight (2): rho(x) = t^2/6 (1 - [1 - (x/t)^2]^3) for |x| <= t, else t^2/6.
double tukey_rho(double x, double t);
// IRLS weight rho'(x) / x = [1 - (x/t)^2]^2 for |x| <= t, else 0.
double tukey_weight(double x, double t);

// The upper one of two in the middle. Reorders `values`; 0 when empty.
double upper_median(std::vector<double>& values);

// Standard deviation of one axis of a 2D Gaussian from the norms of its samples, by the median (robust to half
// outliers). Reorders `norms`; 0 when empty.
double robust_sigma_2d(std::vector<double>& norms);

}  // namespace coslam
