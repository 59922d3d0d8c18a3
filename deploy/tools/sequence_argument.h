// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/dataset/sequence.h"

namespace coslam {

// The SEQUENCE of a command line: a YAML file, a folder with sequence.yaml, or sim:NAME, rendered when it is not yet in
// the cache. Throws UserError.
Sequence sequence_argument(const std::string& text);

}  // namespace coslam
