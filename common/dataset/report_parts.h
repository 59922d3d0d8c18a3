// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "common/base/log.h"
#include "common/base/metrics.h"
#include "common/model/image_account.h"

// Parts of report.json that more than one program writes or reads.
namespace coslam {

// {"captured": 300, "tracked": 281, ...}: a number for each fate.
nlohmann::ordered_json json_of(const ImageAccount& images);
// Reads the image account of an agent in a report; all 0 where it has none.
ImageAccount images_of(const nlohmann::json& agent);

// {"STAGE": {"p50": 1.2, "p95": ..., "p99": ..., "mean": ..., "count": 300}, ...}: times of stages by name, ms.
nlohmann::ordered_json json_of(const StageTimes& times);

// [{"text": "...", "count": 3}, ...], as UTF-8 whatever the texts hold.
nlohmann::ordered_json json_of(const std::vector<Warning>& warnings);
// Reads the warnings of an agent or of a whole report; empty where it has none.
std::vector<Warning> warnings_of(const nlohmann::json& report);

}  // namespace coslam
