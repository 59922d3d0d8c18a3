// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/describer.h"

#include <utility>

namespace coslam {

void Describer::start(DescribeWork work) {
  beside_.start([work = std::move(work)] {
    const auto begin = std::chrono::steady_clock::now();
    DescribeEnd end = work();
    return Described{std::move(end), std::chrono::steady_clock::now() - begin};
  });
}

}  // namespace coslam
