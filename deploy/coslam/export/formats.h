// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/dataset/result.h"
#include "common/dataset/sequence.h"
#include "deploy/coslam/export/export.h"

// The forms that a result is exported in. A new one is a function of export.h and a row of the table in formats.cpp.
namespace coslam::exporting {

enum class UsesSequence { kNever, kIfGiven, kAlways };

struct FormatOptions {
  bool undistort = false;
  std::optional<int> every;  // export only one of so many images
};

struct Format {
  std::string_view name;
  UsesSequence sequence = UsesSequence::kNever;
  bool takes_options = false;  // takes the options of FormatOptions
  // Writes a result. sequence: what was played; null: it is not known.
  Files (*write)(const ResultContents& contents, const std::filesystem::path& folder, const Sequence* sequence,
                 const FormatOptions& options) = nullptr;
  // Names what the form cannot hold of a map, in words; empty: nothing. Null: it holds all.
  std::string (*lacks)(const ResultMap& map) = nullptr;
};

std::span<const Format> formats();
std::vector<std::string> names_of_formats();
// The format must be one of the names.
const Format& format_of(std::string_view name);
// Names of the formats for which that holds: "colmap and ply".
std::string formats_where(bool (*holds)(const Format&));

}  // namespace coslam::exporting
