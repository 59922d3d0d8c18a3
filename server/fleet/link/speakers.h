// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>

#include "common/base/ids.h"
#include "common/wire/loop.h"

namespace coslam {

// Binds each process to the run of its first Hello: only that process may send messages of the run. So a faulty agent
// takes no other's name and no more than one seat. Thread-compatible.
class Speakers {
 public:
  // Whether the writer may send for the run; also true while no process is bound to the run, because messages ahead of
  // its Hello are judged elsewhere.
  bool may_say(RunId run, const WriterId& writer, bool is_hello);
  std::optional<RunId> run_of(const WriterId& writer) const;
  void note_gone(const WriterId& writer) { run_of_.erase(process_of(writer)); }

 private:
  using Process = std::array<std::uint8_t, 12>;  // the part that all writers of a participant share
  static Process process_of(const WriterId& writer);

  std::map<Process, RunId> run_of_;
};

}  // namespace coslam
