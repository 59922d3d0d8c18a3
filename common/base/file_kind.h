// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

// Hints for errors about a file of another kind than the expected one.
namespace coslam {

// Says what a file or folder is to CoSLAM and which command takes it, as the end of a sentence: "; it is a map file,
// ...". Decided by the first bytes, not by the name. Empty when nothing is known of it.
std::string but_it_is(const std::filesystem::path& path);

// Why a file cannot be read, as the end of a sentence: ": there is no such file".
std::string why_unreadable(const std::filesystem::path& file);

}  // namespace coslam
