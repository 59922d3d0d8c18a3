// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/image_name.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace coslam {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::strong_ordering by_value(std::string_view a, std::string_view b) {
  a.remove_prefix(std::min(a.find_first_not_of('0'), a.size()));
  b.remove_prefix(std::min(b.find_first_not_of('0'), b.size()));
  return a.size() != b.size() ? a.size() <=> b.size() : a <=> b;
}

}  // namespace

Name parts_of(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  Name name{{""}, {}};
  for (std::size_t i = 0; i < stem.size(); ++i) {
    if (!is_digit(stem[i])) {
      name.texts.back() += stem[i];
      continue;
    }
    if (i == 0 || !is_digit(stem[i - 1])) {
      name.numbers.emplace_back();
      name.texts.emplace_back();
    }
    name.numbers.back() += stem[i];
  }
  std::string& before = name.texts.front();
  name.negative = name.numbers.size() == 1 && name.texts.back().empty() && (before == "-" || before.ends_with("_-"));
  if (name.negative) before.pop_back();
  return name;
}

std::strong_ordering in_order(const Name& a, const Name& b) {
  if (a.negative != b.negative) return b.negative <=> a.negative;
  if (a.negative) return by_value(b.numbers.front(), a.numbers.front());
  for (std::size_t i = 0; i < std::min(a.texts.size(), b.texts.size()); ++i) {
    if (a.texts[i] != b.texts[i]) return a.texts[i] <=> b.texts[i];
    if (i >= a.numbers.size() || i >= b.numbers.size()) break;
    if (const auto order = by_value(a.numbers[i], b.numbers[i]); order != 0) return order;
  }
  return a.texts.size() <=> b.texts.size();
}

std::string family_of(const Name& name) {
  std::string family = name.texts.front();
  for (std::size_t i = 0; i < name.numbers.size(); ++i) {
    const std::string& before = name.texts[i];
    const std::string& after = name.texts[i + 1];
    const bool of_camera = name.numbers[i].size() == 1 && i + 1 < name.numbers.size() &&
                           (after.starts_with('_') || after.starts_with('-')) && !before.empty() &&
                           std::isalpha(static_cast<unsigned char>(before.back()));
    family += (of_camera ? name.numbers[i] : "#") + after;
  }
  return family;
}

}  // namespace coslam
