// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/dataset/sequence.h"

namespace coslam {

// A YAML file, a folder with sequence.yaml or sim:NAME; a path that is not there counts as one, too.
bool names_sequence(const std::string& text);

// An agent for each source (one or more: videos, folders of images, topics, cameras), named for it, without
// calibrations. When sources of different clocks began against the first is left open. Throws UserError.
Sequence sequence_of_sources(const std::vector<std::string>& sources);

// Agents that see the same images at the same time, as of a line that was copied: a sentence for the user, or empty.
std::string shared_source(const std::vector<SequenceAgent>& agents);

}  // namespace coslam
