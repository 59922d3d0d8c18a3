// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "server/show/bridge/bridge_config.h"

namespace coslam {

// Hands on what the map server tells the public to ROS 2 nodes, and an agent's poses to PX4, until it is destroyed.
// Hears the fleet in one DDS domain and speaks in another, with threads of its own.
class Bridge {
 public:
  // Throws UserError, one sentence: one domain for both, an interface that is not there, the key.
  explicit Bridge(const BridgeOptions& options);
  ~Bridge();
  Bridge(const Bridge&) = delete;
  Bridge& operator=(const Bridge&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coslam
