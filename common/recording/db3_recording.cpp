// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The SQLite databases of rosbag2: tables `topics` (id, name, type, serialization_format) and `messages` (id, topic_id,
// timestamp, data).
#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <set>
#include <system_error>

#include "common/base/error.h"
#include "common/base/file_kind.h"
#include "common/recording/containers.h"

namespace coslam::recording {
namespace {

constexpr TimeNs kFarthest_ns = 4'000'000'000'000'000'000;  // the year 2096: differences stay in range
constexpr int kMostOctets = 1 << 30;                        // of a message

// A log beside it holds what a recorder that was killed wrote last; without one the file is taken as it is, so that it
// may lie where nothing can be written.
std::string address_of(const std::filesystem::path& file) {
  std::string address = "file:";
  for (const char c : std::filesystem::absolute(file).string()) {
    const auto octet = static_cast<unsigned char>(c);
    if (std::isalnum(octet) != 0 || c == '/' || c == '.' || c == '_' || c == '-') {
      address += c;
    } else {
      char escaped[4];
      std::snprintf(escaped, sizeof escaped, "%%%02X", static_cast<unsigned>(octet));
      address += escaped;
    }
  }
  std::filesystem::path log = file;
  log += "-wal";
  std::error_code none;
  const bool has_log = std::filesystem::file_size(log, none) > 0 && !none;
  return address + (has_log ? "?mode=ro" : "?mode=ro&immutable=1");
}

class Db3Recording final : public Recording {
 public:
  Db3Recording(const std::filesystem::path& file, std::string name) : name_(std::move(name)) {
    try {
      database_ = std::make_unique<SQLite::Database>(address_of(file), SQLite::OPEN_READONLY | SQLite::OPEN_URI);
      harden();
      read_topics();
    } catch (const SQLite::Exception& e) {
      fail(e);
    }
  }

  const std::vector<Topic>& topics() const override { return topics_; }
  TimeNs first_ns() const override { return first_ns_; }
  const std::string& warning() const override { return warning_; }

  void play(std::size_t topic) override {
    try {
      const std::string order = whole_ ? "timestamp, rowid" : "rowid";
      list_ = std::make_unique<SQLite::Statement>(*database_,
                                                  "SELECT rowid, topic_id, timestamp FROM messages ORDER BY " + order);
      octets_ = std::make_unique<SQLite::Statement>(*database_, "SELECT data FROM messages WHERE rowid = ?");
      played_ = ids_.at(topic);
      ahead_.reset();
    } catch (const SQLite::Exception& e) {
      fail(e);
    }
  }

  std::optional<Message> next() override {
    if (whole_) return read_next();
    // The last message of what was cut off may lack its end, which reads as zeros.
    std::optional<Message> message = std::exchange(ahead_, read_next());
    if (!message) message = std::exchange(ahead_, read_next());
    return ahead_ ? std::move(message) : std::nullopt;
  }

 private:
  std::optional<Message> read_next() {
    try {
      while (list_ && list_->executeStep()) {
        if (!played_.contains(list_->getColumn(1).getInt64())) continue;
        const TimeNs noted_ns = std::clamp<TimeNs>(list_->getColumn(2).getInt64(), 0, kFarthest_ns);
        return Message{noted_ns, message_octets(list_->getColumn(0).getInt64())};
      }
      list_.reset();
      return std::nullopt;
    } catch (const SQLite::Exception& e) {
      list_.reset();
      if (whole_) fail(e);
      return std::nullopt;  // the rest is cut off, as warning() says
    }
  }

  [[noreturn]] void fail(const SQLite::Exception& e) const {
    throw UserError(name_ + ": is damaged, or no recording of rosbag2: " + e.what());
  }

  // A database may bring code of its own: views, triggers, functions. None of it is run.
  void harden() {
    sqlite3* handle = database_->getHandle();
    sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, kMostOctets);
    database_->exec("PRAGMA trusted_schema = OFF");
    database_->exec("PRAGMA cell_size_check = ON");
    try {
      require_tables();
    } catch (const SQLite::Exception& e) {
      if (e.getErrorCode() != SQLITE_CORRUPT) throw;
      // SQLite refuses what is shorter than its header says, except for repairs.
      database_->exec("PRAGMA writable_schema = ON");
      require_tables();
      whole_ = false;
      warning_ = name_ + ": was cut off, what is there is read";
    }
  }

  void require_tables() {
    for (const char* table : {"topics", "messages"}) {
      SQLite::Statement statement(*database_,
                                  "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name = ? AND "
                                  "rootpage > 0 AND sql NOT LIKE '%GENERATED%' AND sql NOT LIKE '% AS (%'");
      statement.bind(1, table);
      if (!statement.executeStep() || statement.getColumn(0).getInt() != 1) {
        throw UserError(name_ + ": is no recording of rosbag2: it has no table " + table + but_it_is(name_));
      }
    }
  }

  void read_topics() {
    SQLite::Statement topics(*database_, "SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    while (topics.executeStep()) {
      const std::size_t topic = place_of(
          {topics.getColumn(1).getString(), topics.getColumn(2).getString(), topics.getColumn(3).getString()}, topics_);
      ids_.resize(topics_.size());
      ids_[topic].insert(topics.getColumn(0).getInt64());
    }
    SQLite::Statement first(*database_, whole_ ? "SELECT min(timestamp) FROM messages"
                                               : "SELECT timestamp FROM messages ORDER BY rowid LIMIT 1");
    if (first.executeStep()) first_ns_ = std::clamp<TimeNs>(first.getColumn(0).getInt64(), 0, kFarthest_ns);
  }

  std::string message_octets(std::int64_t row) {
    octets_->reset();
    octets_->bind(1, row);
    return octets_->executeStep() ? octets_->getColumn(0).getString() : std::string();
  }

  const std::string name_;
  std::unique_ptr<SQLite::Database> database_;
  bool whole_ = true;  // false: messages are read as they lie there, until the first that is missing
  std::string warning_;
  std::vector<Topic> topics_;
  std::vector<std::set<std::int64_t>> ids_;  // of each topic
  TimeNs first_ns_ = 0;

  std::set<std::int64_t> played_;
  std::optional<Message> ahead_;  // while not whole_
  std::unique_ptr<SQLite::Statement> list_, octets_;
};

}  // namespace

std::unique_ptr<Recording> open_db3(const std::filesystem::path& file, const std::string& name) {
  return std::make_unique<Db3Recording>(file, name);
}

}  // namespace coslam::recording
