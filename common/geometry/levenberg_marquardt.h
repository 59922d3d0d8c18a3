// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace coslam {

// Damping of the normal equations, as a factor on their diagonal: H + lambda diag(H).
struct Damping {
  double first = 1e-4;          // at a start that may be far off; smaller where it is known to be near
  double least = 1e-9;          // after many steps that helped
  double most = 1e6;            // limit, beyond which no step helps
  double after_failure = 0;     // at least so much after a step that did not help
  bool counts_failures = true;  // whether a step that did not help is one of the iterations
};

enum class LmStep {
  kFailed,     // the cost did not fall; the state is as before
  kImproved,   // the state is the new one
  kConverged,  // the state is the new one, and no further step is worth its time
  kImpossible  // the equations have no finite solution
};

// Minimises by Levenberg and Marquardt: tries steps with more damping until one lowers the cost, with less from then
// on. step(lambda) solves the damped equations around the present state, moves the state there when the cost falls, and
// says what came of it. Returns the number of iterations; the one that ended it does not count.
template <class Step>
int levenberg_marquardt(const Damping& damping, int max_iterations, Step step) {
  double lambda = damping.first;
  int iterations = 0;
  while (iterations < max_iterations && lambda < damping.most) {
    const LmStep outcome = step(lambda);
    if (outcome == LmStep::kImpossible || outcome == LmStep::kConverged) break;
    const bool failed = outcome == LmStep::kFailed;
    lambda = failed ? std::max(10 * lambda, damping.after_failure) : std::max(damping.least, 0.1 * lambda);
    if (!failed || damping.counts_failures) ++iterations;
  }
  return iterations;
}

}  // namespace coslam
