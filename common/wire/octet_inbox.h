// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/base/time.h"
#include "common/wire/octet_topic.h"

namespace coslam {

// Keeps the newest samples of a topic, as many as its depth, until they are taken: large ones are read where they lie.
// Thread-safe. The participant outlives it.
class OctetInbox {
 public:
  OctetInbox(Participant& participant, const OctetTopic& topic);
  ~OctetInbox();
  OctetInbox(const OctetInbox&) = delete;
  OctetInbox& operator=(const OctetInbox&) = delete;

  // Hands the oldest sample to `read`, which must not throw and while which nothing more is received; then it is gone.
  // Returns when it had come, UTC; empty: there is none.
  using OnOctets = std::function<void(std::span<const std::uint8_t> octets)>;
  std::optional<TimeNs> take(OnOctets read);
  // Waits until a sample comes, at most so long.
  void wait(std::chrono::milliseconds most);

  int writers() const;  // matched now
  // Samples between those that were taken that were not: lost on the way, or gone when newer ones needed the room.
  std::uint64_t missed() const;
  // The QoS by which a writer does not match, by its name in DDS; empty: none was met.
  std::string unmatched_qos() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coslam
