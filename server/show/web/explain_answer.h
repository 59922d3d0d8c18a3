// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/dataset/result_folder.h"
#include "server/keep/explain/answer.h"
#include "server/show/web/answer.h"

// /api/v1/explain: what `coslam explain` says of a result.
namespace coslam {

// Parses a request; empty: it is no question.
std::optional<explain::Question> question_of(const WebRequest& request);
WebAnswer no_question();
// Reads the events of the run, which may take a while.
WebAnswer explained(const ResultFolder& result, const explain::Question& question);

}  // namespace coslam
