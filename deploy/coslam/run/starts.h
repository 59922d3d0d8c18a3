// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/dataset/sequence.h"

namespace coslam {

// Source of an agent's start time, most trusted first.
enum class StartBy : std::uint8_t { kGiven, kReference, kSound, kTurning, kWhatMoves, kNothing };

std::string_view words_of(StartBy start_by);

// Aligns recordings that were started separately in time. Sets `start_s` of the sequence's agents whose start is open;
// one that is given stays. Where none is given the first agent is the reference, and all are moved so that nothing of
// any is left out.
class Starts {
 public:
  // Begins with the sound of videos.
  explicit Starts(Sequence* sequence);

  // Uses the result of a run: how things move, and how cameras that are held together turn. True when a source is to
  // begin at another time than it did, so that the run is worth repeating.
  bool improve(const std::filesystem::path& result);

  // Says of each agent when it began and by what, or that nothing tells, in one sentence.
  void say() const;
  // Adds what tells each start to the report of a run, and writes a sequence.yaml beside it with the starts and the
  // lenses that were found, for the next time, where there is none yet.
  void write(const std::filesystem::path& result) const;

 private:
  struct Link {
    std::string first, second;
    double later_s = 0;  // the second source began so much later
    StartBy start_by = StartBy::kSound;
  };
  struct Known {
    StartBy start_by = StartBy::kGiven;
    std::string against;
  };
  void link(const Link& link);
  void link_by_result(const std::filesystem::path& result);
  enum class Change : std::uint8_t { kAny, kWorthARun };
  bool settle(Change change);

  Sequence& sequence_;
  const std::vector<SequenceAgent> asked_;
  bool reference_ = false;  // the first stands for a start that is given
  std::vector<Link> links_;
  std::map<std::string, Known> known_;
};

}  // namespace coslam
