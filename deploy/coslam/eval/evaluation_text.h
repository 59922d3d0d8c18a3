// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "deploy/coslam/eval/evaluation.h"

namespace coslam::eval {

// The evaluation as one screen of text.
std::string to_text(const Evaluation& evaluation);

}  // namespace coslam::eval
