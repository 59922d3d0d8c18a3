// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <utility>

#include "common/base/error.h"
#include "common/base/log.h"
#include "common/wire/address_watch.h"

namespace coslam {

// Membership of a link in its domain: holds its ends there (its participant, writers and readers). When this machine's
// addresses change it leaves and joins anew, since the middleware goes by the addresses that it found at its start.
// Thread-safe. Ends have a `participant`.
template <class Ends>
class Membership {
 public:
  struct Steps {
    std::function<std::unique_ptr<Ends>()> open;  // joins; throws UserError
    std::function<void(const Ends&)> leaving;     // the ends are about to close, and nobody uses them any more
    std::function<void()> left;                   // the ends are closed
    std::function<void(Ends&)> joined_anew;
  };

  // Joins. The steps other than open() are called on a thread of their own.
  Membership(Steps steps, const AddressWatch::Addresses& addresses)
      : steps_(std::move(steps)), ends_(steps_.open()), watch_(addresses, [this] { return join_anew(); }) {}

  // The ends, which stay open while this lives; none while the link joins anew. Held for a write at most.
  class Held {
   public:
    explicit Held(const Membership& membership) : lock_(membership.mutex_), ends_(membership.ends_.get()) {}
    explicit operator bool() const { return ends_ != nullptr; }
    Ends& operator*() const { return *ends_; }
    Ends* operator->() const { return ends_; }

   private:
    std::shared_lock<std::shared_mutex> lock_;
    Ends* ends_;
  };
  Held ends() const { return Held(*this); }

 private:
  // False: it could not join, and is to try again.
  bool join_anew() {
    if (auto before = take()) {
      log_info("this machine's addresses changed: joining DDS domain " +
               std::to_string(before->participant.config().domain) + " anew");
      before->participant.give_up();
      before.reset();  // says farewell
      steps_.left();
    }
    try {
      auto fresh = steps_.open();
      const std::unique_lock lock(mutex_);
      ends_ = std::move(fresh);
    } catch (const UserError& error) {
      if (cannot_join_.pass()) log_warn(error.what());
      return false;
    }
    const std::shared_lock lock(mutex_);
    steps_.joined_anew(*ends_);
    return true;
  }

  std::unique_ptr<Ends> take() {
    const std::unique_lock lock(mutex_);
    if (ends_) steps_.leaving(*ends_);
    return std::move(ends_);
  }

  const Steps steps_;
  mutable std::shared_mutex mutex_;  // for the next
  std::unique_ptr<Ends> ends_;
  LogLimiter cannot_join_;
  AddressWatch watch_;  // last: stops first
};

}  // namespace coslam
