// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/address_watch.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>

namespace coslam {
namespace {

constexpr std::chrono::milliseconds kLookEvery{500};

bool reaches_others(const std::string& address) { return !address.starts_with("127."); }

}  // namespace

AddressWatch::AddressWatch(const Addresses& addresses, const std::function<bool()>& join_anew)
    : worker_("addresses", [joined_with = addresses(), addresses, join_anew](const std::stop_token& stop) mutable {
        std::mutex mutex;
        std::condition_variable_any stopped;
        std::unique_lock lock(mutex);
        while (!stopped.wait_for(lock, stop, kLookEvery, [] { return false; }) && !stop.stop_requested()) {
          const std::vector<std::string> now = addresses();
          if (now == joined_with || !std::ranges::any_of(now, reaches_others)) continue;
          if (join_anew()) joined_with = now;
        }
      }) {}

}  // namespace coslam
