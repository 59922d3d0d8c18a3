// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common/base/ids.h"
#include "common/base/time.h"

// The folders of a server's runs: each run has one of its own, below the folder that the user named.
namespace coslam {

// `20261123T084512Z-00c0ffee00c0ffee`: when it began, UTC, and the run. Sorts by time.
std::string run_folder_name(TimeNs utc_ns, RunId run);

// Makes the folder of the runs, or throws UserError when no folder can be made in it.
void make_folder_of_runs(const std::filesystem::path& runs);

// A new folder for a run. Throws UserError, also when there is one of that name.
std::filesystem::path make_run_folder(const std::filesystem::path& runs, TimeNs utc_ns, RunId run);

// Lets `latest` beside the folder of a run name it, in one step: whoever looks finds this run or the one before. Throws
// UserError, also when something else than a link has that name.
void link_latest(const std::filesystem::path& run_folder);

}  // namespace coslam
