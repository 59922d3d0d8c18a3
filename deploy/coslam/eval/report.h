// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "deploy/coslam/eval/evaluation.h"

namespace coslam::eval {

// eval.json, see docs/configuration.md; null where a figure is not known.
nlohmann::ordered_json to_json(const Evaluation& evaluation);

// The evaluation as one screen of text.
std::string to_text(const Evaluation& evaluation);

}  // namespace coslam::eval
