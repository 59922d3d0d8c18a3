// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json_fwd.hpp>

#include "server/estimator/map_server.h"
#include "server/keep/loop_facts.h"

namespace coslam {

// View of a server at work for its observers.
struct ServerView {
  const MapServer& server;
  bool at_work = false;              // no other server is in its domain
  std::size_t agents = 0;            // number that have joined so far
  std::function<LoopFacts()> facts;  // collects them when it is called
};

// Outcome of a frame set, beside the new state of the map.
struct SetOutcome {
  const FrameSet& set;
  const PastPart& past;  // data that left the map's memory
};

// Observer of a server at work. Called by the map's thread, which waits meanwhile.
class SetObserver {
 public:
  SetObserver() = default;
  virtual ~SetObserver() = default;
  SetObserver(const SetObserver&) = delete;
  SetObserver& operator=(const SetObserver&) = delete;

  // Whether the server has to keep its journal of changes for this observer.
  virtual bool wants_journal() const { return false; }

  virtual void after_set(const SetOutcome& outcome, const ServerView& view) = 0;
  // Called often, also while no frame set comes.
  virtual void idle(const ServerView& /*view*/) {}
  // No more frame sets come; the map is adjusted as a whole next. May throw UserError: the others are called all the
  // same.
  virtual void ending(const ServerView& /*view*/, const nlohmann::ordered_json& /*report*/) {}
  // The run is over and the map is final. May throw UserError like ending().
  virtual void ended(const ServerView& /*view*/, const nlohmann::ordered_json& /*report*/) {}
};

}  // namespace coslam
