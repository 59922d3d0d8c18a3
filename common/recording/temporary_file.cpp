// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recording/temporary_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "common/base/error.h"

namespace coslam::recording {
namespace {

constexpr std::uint64_t kLeftToOthers = 256ULL << 20U, kBetweenChecks = 16ULL << 20U;

}  // namespace

TemporaryFile::TemporaryFile() {
  std::error_code error;
  std::string pattern = (std::filesystem::temp_directory_path(error) / "coslam-XXXXXX").string();
  if (!error) descriptor_ = mkstemp(pattern.data());
  if (descriptor_ < 0) throw UserError("no temporary file can be made in $TMPDIR, or /tmp without it");
  path_ = pattern;
}

TemporaryFile::~TemporaryFile() {
  close(descriptor_);
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void TemporaryFile::write(std::string_view octets) {
  unchecked_ += octets.size();
  if (unchecked_ >= kBetweenChecks) {
    unchecked_ = 0;
    std::error_code error;
    const auto space = std::filesystem::space(path_.parent_path(), error);
    if (!error && space.available < kLeftToOthers) {
      throw UserError(path_.parent_path().string() + ": has no room for the recording, decompressed; $TMPDIR names " +
                      "another folder");
    }
  }
  while (!octets.empty()) {
    const ssize_t written = ::write(descriptor_, octets.data(), octets.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw UserError(path_.string() + ": cannot be written: " + std::strerror(errno));
    octets.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace coslam::recording
