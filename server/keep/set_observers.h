// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/keep/set_observer.h"

namespace coslam {

// List of those that watch a server at work, called in the order in which they came. An observer that fails at the end
// keeps nothing from the others.
class SetObservers {
 public:
  // The observer outlives the last call.
  void add(SetObserver& observer) { all_.push_back(&observer); }

  void after_set(const SetOutcome& outcome, const ServerView& view) const;
  void idle(const ServerView& view) const;
  // Sentences about what could not be written.
  std::vector<std::string> ending(const ServerView& view, const nlohmann::ordered_json& report) const;
  std::vector<std::string> ended(const ServerView& view, const nlohmann::ordered_json& report) const;

 private:
  std::vector<SetObserver*> all_;
};

}  // namespace coslam
