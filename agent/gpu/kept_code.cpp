// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/kept_code.h"

#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "common/base/cache_folder.h"

namespace coslam {
namespace {

namespace fs = std::filesystem;

// FNV-1a. Only a name: the key is in the file too.
std::string name_of(std::string_view key) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : key) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return std::to_string(hash) + ".code";
}

// Before and after the code: one that was cut off lacks the second.
std::string framed(const std::string& key, std::string_view code) {
  return key + '\n' + std::to_string(code.size()) + '\n' + std::string(code) + "end";
}

}  // namespace

KeptCode KeptCode::of_user() {
  const auto folder = cache_folder();
  return KeptCode(folder ? *folder / "gpu" : fs::path());
}

fs::path KeptCode::file_of(const std::string& key) const { return folder_ / name_of(key); }

std::optional<std::vector<char>> KeptCode::find(const std::string& key) const {
  if (folder_.empty()) return std::nullopt;
  std::ifstream file(file_of(key), std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!text.starts_with(key + '\n')) return std::nullopt;
  const std::size_t number = key.size() + 1, line_end = text.find('\n', number);
  if (line_end == std::string::npos) return std::nullopt;
  const auto from = text.begin() + static_cast<std::ptrdiff_t>(line_end) + 1;
  if (text.end() - from < 3) return std::nullopt;
  const std::vector<char> code(from, text.end() - 3);
  if (text != framed(key, {code.data(), code.size()})) return std::nullopt;
  return code;
}

void KeptCode::keep(const std::string& key, const std::vector<char>& code) const {
  if (folder_.empty()) return;
  std::error_code error;
  fs::create_directories(folder_, error);
  // Several agents may start at once: each writes its own, and the last one stays.
  const fs::path file = file_of(key), fresh = file.string() + "." + std::to_string(getpid());
  std::ofstream out(fresh, std::ios::binary);
  out << framed(key, {code.data(), code.size()});
  out.close();
  if (out) fs::rename(fresh, file, error);
  if (!out || error) fs::remove(fresh, error);
}

}  // namespace coslam
