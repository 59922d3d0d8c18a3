// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/store/saver.h"

#include <utility>

#include "common/base/error.h"

namespace coslam {

Saver::Saver(Write write, std::chrono::milliseconds retry)
    : write_(std::move(write)),
      retry_(retry),
      worker_("map-file", [this](const std::stop_token& stop) { run(stop); }) {}

Saver::~Saver() = default;

bool Saver::idle() const {
  const std::lock_guard lock(mutex_);
  return waiting_.empty();
}

void Saver::give(std::vector<Row> rows) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(rows));
  }
  changed_.notify_all();
}

std::optional<std::string> Saver::accept_agent_pose() {
  const std::lock_guard lock(mutex_);
  if (words_.empty()) return std::nullopt;
  std::optional<std::string> word(std::move(words_.front()));
  words_.pop_front();
  return word;
}

void Saver::finish(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  if (changed_.wait_for(lock, patience, [this] { return waiting_.empty(); })) return;
  throw UserError(failure_.empty() ? "the map file could not be written in time: the disk is slow" : failure_);
}

void Saver::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return !waiting_.empty(); })) {
    const std::vector<Row>& rows = waiting_.front();  // stays where it is while others are added behind
    lock.unlock();
    const bool written = try_write(rows);
    lock.lock();
    if (written) {
      waiting_.pop_front();
      changed_.notify_all();
    } else if (stop.stop_requested()) {
      return;  // nobody waits any more, and the disk takes nothing
    } else {
      changed_.wait_for(lock, stop, retry_, [] { return false; });
    }
  }
}

bool Saver::try_write(const std::vector<Row>& rows) {
  std::string failure;
  try {
    write_(rows);
  } catch (const UserError& e) {
    failure = e.what();
  }
  const std::lock_guard lock(mutex_);
  if (!failure.empty() && failure_.empty()) {
    words_.push_back(failure + "; mapping goes on, and what is not saved is kept");
  }
  if (failure.empty() && !failure_.empty()) words_.emplace_back("the map file is written again");
  failure_ = failure;
  return failure.empty();
}

}  // namespace coslam
