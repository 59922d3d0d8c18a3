// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

// Tells what the disk lets a program do with a map file. The write-ahead log and the folder belong to the file as well.
namespace coslam {

// Path of the file's write-ahead log.
std::filesystem::path log_of(std::filesystem::path file);
// Tells whether the log holds what was written last; readers leave an empty one behind.
bool has_log(const std::filesystem::path& file);
// Tells whether the file exists and is not empty. Throws UserError for a folder, a pipe and the like: to open one may
// take for ever.
bool holds_something(const std::filesystem::path& file);
// Tells whether nobody may change the file: nothing may be written in its folder, and it has no log. SQLite reads such
// a file only as one that is immutable.
bool nobody_writes(const std::filesystem::path& file);
// Reason why the file cannot be opened, as the end of a sentence that begins with its name.
std::string access_cause(const std::filesystem::path& file);

}  // namespace coslam
