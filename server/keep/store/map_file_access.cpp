// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/store/map_file_access.h"

#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "common/base/error.h"

namespace coslam {
namespace {

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

}  // namespace

std::filesystem::path log_of(std::filesystem::path file) { return file += "-wal"; }

bool has_log(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::exists(log_of(file), error) && std::filesystem::file_size(log_of(file), error) > 0;
}

bool holds_something(const std::filesystem::path& file) {
  std::error_code error;
  const auto type = std::filesystem::status(file, error).type();
  if (type == std::filesystem::file_type::directory) throw UserError("map file " + file.string() + " is a folder");
  if (!std::filesystem::exists(file, error)) return false;
  if (type != std::filesystem::file_type::regular) throw UserError("map file " + file.string() + " is no file");
  return std::filesystem::file_size(file, error) > 0;
}

bool nobody_writes(const std::filesystem::path& file) {
  return access(folder_of(file).c_str(), W_OK) != 0 && !has_log(file);
}

std::string access_cause(const std::filesystem::path& file) {
  const std::filesystem::path folder = folder_of(file);
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) return "cannot be there: there is no folder " + folder.string();
  const bool exists = std::filesystem::exists(file, error);
  if (exists && access(file.c_str(), R_OK) != 0) return "may not be read by this user";
  for (const auto& path : {file, folder}) {
    if ((path == file && !exists) || access(path.c_str(), W_OK) == 0) continue;
    if (errno == EROFS) return "cannot be written: its disk is read-only";
    return path == file ? "may not be written by this user"
                        : "cannot be written: this user may not write in the folder " + folder.string();
  }
  return "cannot be opened";
}

}  // namespace coslam
