// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <filesystem>
#include <string>
#include <vector>

namespace coslam {

// A name between its numbers: texts[0] numbers[0] texts[1] numbers[1] ... texts.back().
struct Name {
  std::vector<std::string> texts, numbers;
  bool negative = false;  // the name is one number below 0, whose sign is no text
};

Name parts_of(const std::filesystem::path& file);

// Text by text and number by number, after the negative numbers.
std::strong_ordering in_order(const Name& a, const Name& b);

// Common part of the names of one camera: `left_#`. A single digit behind a letter, before `_` or `-` and a further
// number, tells cameras apart: `cam0_#`.
std::string family_of(const Name& name);

}  // namespace coslam
