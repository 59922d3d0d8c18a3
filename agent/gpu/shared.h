// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>

namespace coslam {

// Shares an object among the devices of a process: the last T that was made of `from`, while one of them has it, else a
// new one. T has is_of(from...).
template <class T, class... From>
std::shared_ptr<const T> shared_of(const From&... from) {
  static std::mutex mutex;
  static std::weak_ptr<const T> last;
  const std::lock_guard lock(mutex);
  std::shared_ptr<const T> shared = last.lock();
  if (!shared || !shared->is_of(from...)) {
    shared = std::make_shared<const T>(from...);
    last = shared;
  }
  return shared;
}

}  // namespace coslam
