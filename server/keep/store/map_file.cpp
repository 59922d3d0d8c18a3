// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/store/map_file.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>
#include <zlib.h>

#include <cstdio>
#include <functional>
#include <system_error>
#include <utility>

#include "common/base/error.h"
#include "common/base/file_kind.h"
#include "server/keep/store/map_file_access.h"
#include "server/keep/store/writer_lock.h"

namespace coslam {
namespace {

constexpr int kApplication = 0x434f534c;  // "COSL"
constexpr int kVersion = kRowsVersion;

const char* const kTables =
    "CREATE TABLE IF NOT EXISTS rows (name TEXT NOT NULL, number INTEGER NOT NULL, octets BLOB NOT NULL, "
    "crc32 INTEGER NOT NULL, PRIMARY KEY (name, number)) WITHOUT ROWID;"
    "CREATE TABLE IF NOT EXISTS saved (utc_ns INTEGER NOT NULL);";
// Has a row while a process writes, in the file itself, so that a copy has it too.
const char* const kMark =
    "BEGIN; CREATE TABLE IF NOT EXISTS in_use (yes INTEGER NOT NULL); INSERT INTO in_use VALUES (1); COMMIT";

std::int64_t check_sum(const void* octets, std::size_t size) {
  return static_cast<std::int64_t>(crc32_z(0, static_cast<const Bytef*>(octets), size));
}

std::string cause_of(const SQLite::Exception& e, const std::filesystem::path& file) {
  switch (e.getErrorCode()) {
    case SQLITE_NOTADB:
      return "is no map of CoSLAM" + but_it_is(file);
    case SQLITE_CORRUPT:
      return "is damaged";
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "is in use by another process";
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
    case SQLITE_CANTOPEN:
      return access_cause(file);
    case SQLITE_FULL:
      return "cannot be written: the disk is full";
    default:
      return std::string("cannot be used: ") + e.what();
  }
}

std::string uri_of(const std::filesystem::path& file) {
  std::string out = "file:";
  for (const char c : file.string()) {
    char code[4];
    std::snprintf(code, sizeof code, "%%%02x", static_cast<unsigned char>(c));
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/';
    out += plain ? std::string(1, c) : code;
  }
  return out + "?immutable=1";
}

SQLite::Database opened(const std::filesystem::path& file, bool writes) {
  constexpr int kPatience_ms = 2000;  // with another process that is about to have written
  if (writes) return {file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, kPatience_ms};
  if (nobody_writes(file)) return {uri_of(file), SQLite::OPEN_READONLY | SQLite::OPEN_URI, kPatience_ms};
  return {file.string(), SQLite::OPEN_READONLY, kPatience_ms};
}

}  // namespace

struct MapFile::Impl {
  Impl(const std::filesystem::path& file, bool writes) : lock(file, writes), db(opened(file, writes)) {}
  ~Impl() {
    try {
      if (marked) db.exec("DELETE FROM in_use");
    } catch (const SQLite::Exception&) {
      // As after a kill: the log stays.
    }
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  // Brings the mark into the file itself, which may take more than one time while others read it.
  void mark() {
    if (in_file) return;
    if (!std::exchange(marked, true)) db.exec(kMark);
    SQLite::Statement query(db, "PRAGMA wal_checkpoint(PASSIVE)");
    in_file = query.executeStep() && query.getColumn(0).getInt() == 0 &&
              query.getColumn(1).getInt() == query.getColumn(2).getInt();
  }

  WriterLock lock;  // goes last: closing it would take the locks that SQLite has
  SQLite::Database db;
  int version = kVersion;  // of what is in it
  bool marked = false, in_file = false;
  std::unique_ptr<SQLite::Statement> put, drop;
};

namespace {

// Runs what is done with the file; says what went wrong in the words of users.
template <class Do>
auto in_words(const std::filesystem::path& path, Do work) {
  try {
    return work();
  } catch (const SQLite::Exception& e) {
    throw UserError("map file " + path.string() + " " + cause_of(e, path));
  }
}

// A process writes the file, or wrote it when it was copied or when that process was killed.
bool is_marked(SQLite::Database& db) {
  return db.tableExists("in_use") && db.execAndGet("SELECT count(*) FROM in_use").getInt() > 0;
}

// Nothing is written to a file that is there already.
void open_for_writing(SQLite::Database& db, bool exists) {
  if (!exists) {
    db.exec("BEGIN; PRAGMA application_id=" + std::to_string(kApplication) +
            "; PRAGMA user_version=" + std::to_string(kVersion) + "; " + kTables + " COMMIT");
    db.exec("PRAGMA journal_mode=WAL");
  }
  db.exec("PRAGMA synchronous=NORMAL");
  db.exec("BEGIN IMMEDIATE; COMMIT");  // it may be written
}

}  // namespace

MapFile::MapFile(const std::filesystem::path& file, Access access) : path_(file) {
  const bool exists = holds_something(file);
  if (!exists && access == Access::kRead) {
    std::error_code error;
    const bool empty = std::filesystem::exists(file, error);
    throw UserError(empty ? "map file " + file.string() + " is empty" : "there is no map file " + file.string());
  }
  const bool log_was_there = has_log(file);
  in_words(path_, [&] {
    impl_ = std::make_unique<Impl>(file, access == Access::kWrite);
    SQLite::Database& db = impl_->db;
    if (exists) {
      const int application = db.execAndGet("PRAGMA application_id").getInt();
      const int version = db.execAndGet("PRAGMA user_version").getInt();
      if (application != kApplication)
        throw UserError("map file " + path_.string() + " is no map of CoSLAM" + but_it_is(path_));
      if (version > kVersion) {
        throw UserError("map file " + path_.string() + " is of version " + std::to_string(version) +
                        ", newer than this program's " + std::to_string(kVersion) + ": update it");
      }
      if (!log_was_there && is_marked(db)) {
        throw UserError("map file " + path_.string() +
                        " was copied while it was written, and what was written last is missing: " +
                        "copy it together with " + log_of(path_).filename().string() + ", or with coslam map copy");
      }
      impl_->version = version;
    }
    if (access == Access::kRead) return;
    // SQLite opens what it may not write to be read.
    if (sqlite3_db_readonly(db.getHandle(), "main") != 0) {
      throw UserError("map file " + path_.string() + " " + access_cause(path_));
    }
    open_for_writing(db, exists);
    impl_->marked = is_marked(db);  // by a process that was killed
    impl_->put = std::make_unique<SQLite::Statement>(
        db,
        "INSERT INTO rows VALUES (?, ?, ?, ?) ON CONFLICT DO UPDATE SET octets = excluded.octets, "
        "crc32 = excluded.crc32");
    impl_->drop = std::make_unique<SQLite::Statement>(db, "DELETE FROM rows WHERE name = ? AND number = ?");
  });
}

MapFile::~MapFile() = default;

namespace {

// The octets of a row; throws UserError when they are not those that were written.
std::string checked(const std::filesystem::path& file, SQLite::Statement& row) {
  const SQLite::Column octets = row.getColumn(2);
  const auto size = static_cast<std::size_t>(octets.getBytes());
  if (check_sum(octets.getBlob(), size) != row.getColumn(3).getInt64()) {
    throw UserError("map file " + file.string() + " is damaged: " + row.getColumn(0).getString() + " " +
                    row.getColumn(1).getString() + " differs from its check sum");
  }
  return {static_cast<const char*>(octets.getBlob()), size};
}

}  // namespace

Tables MapFile::read() const {
  return in_words(path_, [&] {
    Tables tables;
    SQLite::Statement all(impl_->db, "SELECT name, number, octets, crc32 FROM rows WHERE name NOT LIKE 'past%'");
    while (all.executeStep()) tables[all.getColumn(0).getString()][all.getColumn(1).getInt64()] = checked(path_, all);
    return tables;
  });
}

void MapFile::for_each_row(const std::string& table, std::int64_t first, std::int64_t last,
                           const std::function<void(const std::string&)>& visit) const {
  in_words(path_, [&] {
    SQLite::Statement range(impl_->db,
                            "SELECT name, number, octets, crc32 FROM rows WHERE name = ? AND number BETWEEN ? AND ? "
                            "ORDER BY number");
    range.bind(1, table);
    range.bind(2, first);
    range.bind(3, last);
    while (range.executeStep()) visit(checked(path_, range));
  });
}

void MapFile::write(std::span<const Row> rows, TimeNs saved_ns) {
  in_words(path_, [&] {
    impl_->mark();
    SQLite::Transaction transaction(impl_->db);
    for (const Row& row : rows) {
      SQLite::Statement& statement = row.bytes.empty() ? *impl_->drop : *impl_->put;
      statement.reset();
      statement.bindNoCopy(1, row.table);
      statement.bind(2, row.key);
      if (!row.bytes.empty()) {
        statement.bindNoCopy(3, row.bytes.data(), static_cast<int>(row.bytes.size()));
        statement.bind(4, check_sum(row.bytes.data(), row.bytes.size()));
      }
      statement.exec();
    }
    if (std::exchange(impl_->version, kVersion) < kVersion) {
      impl_->db.exec("PRAGMA user_version=" + std::to_string(kVersion));
    }
    impl_->db.exec("DELETE FROM saved");
    impl_->db.exec("INSERT INTO saved VALUES (" + std::to_string(saved_ns) + ")");
    transaction.commit();
  });
}

int MapFile::version() const { return impl_->version; }

std::optional<TimeNs> MapFile::saved_ns() const {
  return in_words(path_, [&]() -> std::optional<TimeNs> {
    SQLite::Statement query(impl_->db, "SELECT utc_ns FROM saved");
    if (!query.executeStep()) return std::nullopt;
    return query.getColumn(0).getInt64();
  });
}

void MapFile::check() const {
  in_words(path_, [&] {
    const std::string verdict = impl_->db.execAndGet("PRAGMA integrity_check").getString();
    if (verdict != "ok") throw UserError("map file " + path_.string() + " is damaged: " + verdict);
    SQLite::Statement all(impl_->db, "SELECT name, number, octets, crc32 FROM rows");
    while (all.executeStep()) checked(path_, all);
  });
}

void MapFile::copy_to(const std::filesystem::path& copy) const {
  std::error_code error;
  if (std::filesystem::exists(copy, error)) throw UserError(copy.string() + " is there already: name another file");
  // A part of a copy would be in the way of the next.
  const auto in_words_or_gone = [&copy](const auto& work) {
    try {
      in_words(copy, work);
    } catch (const UserError&) {
      std::error_code ignored;
      std::filesystem::remove(copy, ignored);
      throw;
    }
  };
  in_words_or_gone([&] {
    SQLite::Statement into(impl_->db, "VACUUM INTO ?");
    into.bind(1, copy.string());
    into.exec();
    SQLite::Database whole(copy.string(), SQLite::OPEN_READWRITE);
    if (whole.tableExists("in_use")) whole.exec("DELETE FROM in_use");
    whole.exec("PRAGMA journal_mode=WAL");
  });
}

void MapFile::compact() {
  in_words(path_, [&] {
    impl_->db.exec("VACUUM");
    impl_->db.exec("PRAGMA wal_checkpoint(TRUNCATE)");
  });
}

}  // namespace coslam
