// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/dataset/result_folder.h"
#include "common/dataset/sequence.h"

namespace coslam {

// Notes the inputs of a result in its report: "sequence" (name, file, and of each agent source, calibration, start),
// and "agent" beside the server's configuration.
void note_played(const Sequence& sequence, const std::vector<std::string>& sets, const ResultFolder& result);

// Whether a sequence is another than the one that a result was made of, as a sentence; empty: it is not, or that is not
// known.
std::string of_another_sequence(const Sequence& sequence, const ResultFolder& result);

}  // namespace coslam
