// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/time.h"

// Small databases as rosbag2 writes them, for tests.
namespace coslam::recording::test {

class Db3File {
 public:
  explicit Db3File(const std::filesystem::path& file)
      : database_(file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE) {
    database_.exec("PRAGMA page_size = 512");
    database_.exec(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT "
        "NOT NULL, offered_qos_profiles TEXT NOT NULL)");
    database_.exec(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data "
        "BLOB "
        "NOT NULL)");
    database_.exec("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  }

  std::int64_t add_topic(const std::string& name, const std::string& type) {
    SQLite::Statement insert(database_,
                             "INSERT INTO topics(name, type, serialization_format, offered_qos_profiles) "
                             "VALUES (?, ?, 'cdr', '')");
    insert.bind(1, name);
    insert.bind(2, type);
    insert.exec();
    return database_.getLastInsertRowid();
  }
  void add(std::int64_t topic, TimeNs t_ns, std::string_view octets) {
    SQLite::Statement insert(database_, "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)");
    insert.bind(1, topic);
    insert.bind(2, static_cast<std::int64_t>(t_ns));
    insert.bind(3, octets.data(), static_cast<int>(octets.size()));
    insert.exec();
  }
  void exec(const std::string& statement) { database_.exec(statement); }

 private:
  SQLite::Database database_;
};

// Two topics; message i is "i" in /even or /odd, at i ms.
inline void counted_db3(const std::filesystem::path& file, int from, int to) {
  Db3File db3(file);
  db3.exec("BEGIN");
  const std::int64_t even = db3.add_topic("/even", "std_msgs/msg/String"), odd = db3.add_topic("/odd", "a/msg/B");
  for (int i = from; i < to; ++i) db3.add(i % 2 == 0 ? even : odd, TimeNs{i} * 1'000'000, std::to_string(i));
  db3.exec("COMMIT");
}

}  // namespace coslam::recording::test
