// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/dataset/result_folder.h"

namespace coslam {

// The RESULT of a command line: see find_result(). Says on standard error when it is not whole. Throws UserError.
ResultFolder result_argument(const std::string& named);

}  // namespace coslam
