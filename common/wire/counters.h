// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace coslam {

// Bytes that crossed the link: serialized samples plus the RTPS framing of each, see docs/wire.md. "Up" is towards the
// server on either side.
struct LinkBytes {
  std::uint64_t up = 0;
  std::uint64_t down = 0;
};

// Why a sample was not used. The decoder finds the first group, Admission and the joiner the second, the guard
// around the middleware the third.
enum class Rejection : std::uint8_t {
  kMalformed,        // cannot be decoded: truncated or overlong
  kNotFinite,        // NaN or infinity
  kOutOfRange,       // a number, coordinate or enumerator outside its range
  kTooMany,          // a count above its bound
  kSizeMismatch,     // arrays that must have the same length do not
  kIdsNotAscending,  // ids repeated or out of order
  kBadId,            // id 0 where one is required
  kBadRotation,      // quaternion far from unit norm
  kBadText,          // empty, too long or unprintable name or text

  kWrongProtocol,     // speaks another protocol version
  kUnknownAgent,      // no hello from this run (yet)
  kWrongRun,          // a run that was replaced, refused, is another process's, or is not the addressee
  kDuplicate,         // seen before
  kOverflow,          // a bounded buffer was full
  kMissingReference,  // coded against a frame that is not here

  kUnauthentic,  // a datagram without the seal of the fleet's key
  kReplayed,     // a sealed datagram that was here before, or is too old to tell
};
constexpr std::size_t kRejectionCount = 17;

std::string_view name_of(Rejection reason);  // for logs and reports, e.g. "ids_not_ascending"

// Counts rejections by reason. Thread-safe.
class RejectionCounts {
 public:
  void add(Rejection reason) { counts_[static_cast<std::size_t>(reason)].fetch_add(1, std::memory_order_relaxed); }
  std::uint64_t operator[](Rejection reason) const {
    return counts_[static_cast<std::size_t>(reason)].load(std::memory_order_relaxed);
  }
  std::uint64_t total() const;

 private:
  std::array<std::atomic<std::uint64_t>, kRejectionCount> counts_{};
};

}  // namespace coslam
