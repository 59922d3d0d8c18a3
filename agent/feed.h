// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include "agent/capture/source.h"

namespace coslam {

// Hands out the images of a source at the pace wanted.
class Feed {
 public:
  virtual ~Feed() = default;
  // Waits for the next image; empty at the end, and soon after `stop` is set. What is wrong with it stands in `fault`.
  // Of a live source that gives none when one is due: an image that is missing, again and again.
  virtual std::optional<Image> next(const std::atomic<bool>& stop) = 0;
  virtual std::uint32_t dropped() const = 0;
};

// Gives images as fast as they are taken, in the caller's thread.
std::unique_ptr<Feed> direct_feed(std::unique_ptr<ImageSource> source);
// Gives images as fast as they are taken, read ahead in a thread.
std::unique_ptr<Feed> prefetching_feed(std::unique_ptr<ImageSource> source);
// Gives images in real time: played time 0 is at start_utc_ns, and time runs `rate` times as fast. Images that the
// taker has no time for, beyond a short queue, are dropped, oldest first, and counted. Live sources set the pace
// themselves.
std::unique_ptr<Feed> real_time_feed(std::unique_ptr<ImageSource> source, double rate, TimeNs start_utc_ns);

}  // namespace coslam
