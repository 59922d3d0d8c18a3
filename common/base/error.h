// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace coslam {

// A bad environment at start (file, calibration, key, port): what() is one sentence for the user, naming the culprit.
// Thrown at start-up only and caught in main (exit code 1); the running estimator never throws.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Wrong usage of a command line (exit code 2).
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace coslam
