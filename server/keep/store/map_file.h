// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/base/time.h"
#include "server/estimator/map/rows.h"

namespace coslam {

// A map on disk: an SQLite database (write-ahead log) of rows with check sums. What was written before the process is
// killed is there afterwards, each write() whole or not at all. One process at a time may write it; others may read it
// meanwhile, and see it as it was written last, also on a disk or in a folder that they may not write. What was written
// last stands in FILE-wal until the writer ends: a file that was copied meanwhile without it is refused. All functions
// throw UserError with one sentence that names the file and the cause. Thread-compatible; for_each_row() may be called
// while another thread writes.
class MapFile {
 public:
  enum class Access : std::uint8_t { kRead, kWrite };  // kWrite: makes it where there is none

  // Refuses what is no map, of a newer version, of another user, not whole or, to write, in use; nothing is changed
  // then.
  MapFile(const std::filesystem::path& file, Access access);
  ~MapFile();
  MapFile(const MapFile&) = delete;
  MapFile& operator=(const MapFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // Everything but the tables that stay on disk (server/estimator/map/past.h), each row against its check sum. Empty
  // for a new file.
  Tables read() const;
  // Version of the rows in the file, see kRowsVersion; the newest once something was written.
  int version() const;
  // The rows of one table from the first to the last number, ascending.
  void for_each_row(const std::string& table, std::int64_t first, std::int64_t last,
                    const std::function<void(const std::string& octets)>& visit) const;
  // saved_ns: UTC now.
  void write(std::span<const Row> rows, TimeNs saved_ns);
  // Time of the last write; empty for a new file.
  std::optional<TimeNs> saved_ns() const;
  // Looks at every page and every row.
  void check() const;
  // Writes a whole copy, to where there is no file, also while another process writes this one.
  void copy_to(const std::filesystem::path& copy) const;
  // Gives room that is not used back to the disk.
  void compact();

 private:
  struct Impl;
  std::filesystem::path path_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coslam
