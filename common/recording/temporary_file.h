// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace coslam::recording {

// A file in the folder for temporary files ($TMPDIR, else /tmp) that goes with the object; whoever has opened it by
// then reads on.
class TemporaryFile {
 public:
  TemporaryFile();
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // Throws UserError where the disk has no room for more; some of it is always left to others.
  void write(std::string_view octets);

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t unchecked_ = 0;  // octets since the room on the disk was looked at
};

}  // namespace coslam::recording
