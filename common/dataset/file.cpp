// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/file.h"

#include "common/base/error.h"

namespace coslam {

std::ofstream create_file(const std::filesystem::path& file, std::ios::openmode mode) {
  std::error_code ignored;  // shows when the file is opened
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
  std::ofstream stream(file, mode | std::ios::out);
  if (!stream) throw UserError(file.string() + ": cannot be written");
  return stream;
}

void close_file(std::ofstream& stream, const std::filesystem::path& file) {
  stream.close();
  if (!stream) throw UserError(file.string() + ": cannot be written");
}

}  // namespace coslam
