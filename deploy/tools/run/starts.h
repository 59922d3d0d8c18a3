// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "common/dataset/sequence.h"

namespace coslam {

// How it is known when an agent's source began.
enum class StartFrom : std::uint8_t { kGiven, kSound, kWhatMoves, kTurning, kNothing };

std::string_view words_of(StartFrom from);

// Recordings that nobody started together: what tells how they lie in time. `start_s` of the sequence's agents whose
// start is open is set by it.
class Starts {
 public:
  // By the sound of videos.
  explicit Starts(Sequence* sequence);

  // By what a run found: how things move, and how cameras that are held together turn. True when a source is to begin
  // at another time than it did, so that the run is worth repeating.
  bool improve(const std::filesystem::path& result);

  // A warning for each agent of which nothing tells.
  void warn() const;
  // Adds start_s and what tells it to the report of a run, and writes a sequence.yaml beside it with that and the
  // lenses that were found, for the next time.
  void write(const std::filesystem::path& result) const;

 private:
  bool any_open() const;
  bool tied(const std::string& agent) const { return from_.at(agent) != StartFrom::kNothing; }
  void tie(const std::string& agent, const std::string& against, double start_s, StartFrom from);
  // One that was found to have begun first plays from its beginning, and the others so much later.
  void play_all();

  Sequence& sequence_;
  double last_given_s_ = 0;
  std::map<std::string, StartFrom> from_;
};

}  // namespace coslam
