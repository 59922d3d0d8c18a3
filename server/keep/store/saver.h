// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/flow/worker.h"
#include "server/keep/store/map_file.h"

namespace coslam {

// Writes what changed in the map to its file, in a thread of its own: who gives it never waits for the disk. What
// cannot be written is kept and tried again, so that the file is always the whole map of some instant. Thread-safe.
class Saver {
 public:
  // Destination of the rows; MapFile::write but for tests. May throw UserError.
  using Write = std::function<void(const std::vector<Row>&)>;
  explicit Saver(Write write, std::chrono::milliseconds retry = std::chrono::seconds(1));
  ~Saver();
  Saver(const Saver&) = delete;
  Saver& operator=(const Saver&) = delete;

  // Whether everything given before has been written, so that there is room for more. Changes that a slow disk cannot
  // take wait in the map.
  bool idle() const;
  // Queues the rows that changed since the last call; together with the earlier ones they are one state of the map.
  void give(std::vector<Row> rows);
  // Sentence when writing fails, and one when it goes on; each once.
  std::optional<std::string> accept_agent_pose();
  // Waits until all is written, `patience` at most. Throws UserError with the cause when it is not.
  void finish(std::chrono::milliseconds patience);

 private:
  void run(const std::stop_token& stop);
  bool try_write(const std::vector<Row>& rows);

  const Write write_;
  const std::chrono::milliseconds retry_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<std::vector<Row>> waiting_;
  std::string failure_;  // error of the last try; empty: none
  std::deque<std::string> words_;
  Worker worker_;  // last: stops first
};

}  // namespace coslam
