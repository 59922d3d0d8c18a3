// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "common/dataset/result_folder.h"
#include "common/dataset/sequence.h"

namespace coslam {

// The SEQUENCE of a command line: a YAML file, a folder with sequence.yaml, or sim:NAME, rendered when it is not yet in
// the cache. Throws UserError.
Sequence sequence_argument(const std::string& text);
// Takes one sequence, or one source or more, as videos, topics or cameras: an agent each, named for it, without
// calibrations.
Sequence sequence_argument(const std::vector<std::string>& texts);

// The sequence as a run played it: with each source from where its report says that it began, which a run finds out
// where the file leaves it open. What the report does not tell stays.
Sequence as_played(Sequence sequence, const ResultFolder& result);

// A sentence that names the agents there are.
std::string no_such_agent(const Sequence& sequence, const std::string& name);

// Lenses that are covered for a trial: agent, from and to in seconds of played time.
using CoverArguments = std::vector<std::tuple<std::string, double, double>>;
void add_cover_option(CLI::App& command, CoverArguments& covered);
// Throws UsageError for an unknown agent or a span without length.
void cover_lenses(Sequence& sequence, const CoverArguments& covered);

}  // namespace coslam
