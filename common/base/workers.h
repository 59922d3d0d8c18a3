// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace coslam {

// Executes the parts of a piece of work: this class one after the other, derived classes several at a time. A part
// writes where no other reads or writes, so the result is the same to the bit.
class Workers {
 public:
  using Part = std::function<void(std::size_t part)>;

  Workers() = default;
  virtual ~Workers() = default;
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  // Parts that are done at the same time, at most.
  virtual std::size_t at_once() const { return 1; }
  // Executes the parts 0 to n - 1, each once. An exception of a part is thrown when none is at work any more.
  virtual void each(std::size_t n, const Part& part) {
    for (std::size_t i = 0; i < n; ++i) part(i);
  }
  static Workers& alone() {
    static Workers alone;
    return alone;
  }
};

}  // namespace coslam
