// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/flow/worker.h"

namespace coslam {

// Watches this machine's addresses, from before it joined a domain: the middleware goes by those that it found at its
// start, so whoever is reached at others must join anew.
class AddressWatch {
 public:
  using Addresses = std::function<std::vector<std::string>()>;
  // join_anew is called on a thread of its own when the addresses are others and one reaches beyond this machine; when
  // it says false, again half a second later.
  AddressWatch(const Addresses& addresses, const std::function<bool()>& join_anew);

 private:
  Worker worker_;
};

}  // namespace coslam
