// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace coslam {

// Lock of the one process that writes a map file: on an octet behind those that SQLite locks, which readers do not look
// at. It goes with the process.
class WriterLock {
 public:
  // Locks the file, which is made where there is none, if that is wanted. Throws UserError when another process has the
  // lock; a file that cannot be opened is left for SQLite to complain of.
  WriterLock(const std::filesystem::path& file, bool wanted);
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;
  ~WriterLock();

 private:
  int descriptor_ = -1;
};

}  // namespace coslam
