// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/file_kind.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <initializer_list>
#include <string_view>
#include <system_error>

namespace coslam {
namespace {

constexpr const char* kSequence = "; it is a sequence, which coslam run plays";
constexpr const char* kResult = "; it is the result of a run, which coslam view shows";

std::string beginning_of(const std::filesystem::path& file) {
  std::array<char, 4096> begin{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(begin.data(), begin.size());
  return {begin.data(), static_cast<std::size_t>(stream.gcount())};
}

// A line begins with one of the words.
bool has_line(const std::string& text, std::initializer_list<const char*> words) {
  return std::ranges::any_of(words, [&text](const char* word) {
    return text.starts_with(word) || text.find("\n" + std::string(word)) != std::string::npos;
  });
}

bool is_map_file(std::string_view begin) {
  constexpr std::size_t kApplicationId_bytes = 68;  // where SQLite keeps it; that of server/keep/store/map_file.cpp
  return begin.starts_with("SQLite format 3") && begin.size() > kApplicationId_bytes &&
         begin.substr(kApplicationId_bytes, 4) == "COSL";
}

std::string yaml_kind(const std::string& begin) {
  if (has_line(begin, {"agents:"}) && begin.find("source:") != std::string::npos) return kSequence;
  if (has_line(begin, {"id:"}) && has_line(begin, {"source:"}))
    return "; it is the configuration of an agent, which coslam-agent --config takes";
  if (has_line(begin, {"server:"})) return "; it is the configuration of a server, which coslam-server --config takes";
  if (has_line(begin, {"bridge:"})) return "; it is the configuration of a bridge, which coslam-bridge --config takes";
  if (has_line(begin, {"camera_matrix:", "distortion_model:", "fx:", "cam0:", "camera_model:"}))
    return "; it is a calibration, which coslam calibration FILE explains";
  return {};
}

std::string folder_kind(const std::filesystem::path& folder) {
  std::error_code none;
  if (std::filesystem::exists(folder / "report.json", none)) return kResult;
  return std::filesystem::exists(folder / "sequence.yaml", none) ? kSequence : "";
}

}  // namespace

std::string but_it_is(const std::filesystem::path& path) {
  std::error_code none;
  if (std::filesystem::is_directory(path, none)) return folder_kind(path);
  if (!std::filesystem::is_regular_file(path, none)) return {};
  const std::string begin = beginning_of(path);
  if (begin.empty()) return "; it is empty";
  if (is_map_file(begin)) return "; it is a map file, which --map, coslam map and coslam view take";
  if (begin.starts_with("CoSLAMrc")) return "; it is a recording of a run, which coslam replay takes";
  if (begin.starts_with("\x89PNG") || begin.starts_with("\xff\xd8\xff")) return "; it is a picture";
  return yaml_kind(begin);
}

std::string why_unreadable(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) return ": there is no such file";
  if (std::filesystem::is_directory(status)) return ": it is a folder";
  errno = 0;
  const std::ifstream opened(file);
  return opened || errno == 0 ? "" : ": " + std::generic_category().message(errno);
}

}  // namespace coslam
