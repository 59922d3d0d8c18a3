// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace coslam {

// Machine code from one start to the next, since translating takes its time: a file for each key. What cannot be read
// or written is as if it were not kept.
class KeptCode {
 public:
  explicit KeptCode(std::filesystem::path folder) : folder_(std::move(folder)) {}
  // The store in $COSLAM_CACHE/gpu or ~/.cache/coslam/gpu; without either nothing is kept.
  static KeptCode of_user();

  std::optional<std::vector<char>> find(const std::string& key) const;
  void keep(const std::string& key, const std::vector<char>& code) const;

 private:
  std::filesystem::path file_of(const std::string& key) const;

  std::filesystem::path folder_;
};

}  // namespace coslam
