// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "deploy/coslam/eval/evaluation.h"

namespace coslam::eval {

// Contents of eval.json, see docs/configuration.md; null where a figure is not known.
nlohmann::ordered_json to_json(const Evaluation& evaluation);

}  // namespace coslam::eval
