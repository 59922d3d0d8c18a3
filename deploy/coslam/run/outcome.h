// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace coslam {

// A folder holds one run: one that is there is removed with `force`, else refused. Throws UserError.
void make_result_folder(const std::filesystem::path& folder, bool force);

// Prints the summary of a run on standard output, from its report; nothing without one. False, with a sentence on
// standard error, when it mapped nothing.
bool print_summary(const std::filesystem::path& out);

}  // namespace coslam
