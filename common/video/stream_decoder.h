// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/video/picture.h"

namespace coslam {

// The frames of a video file or of a stream from the network, by FFmpeg. For one thread, but for stop().
class StreamDecoder {
 public:
  static constexpr const char* kNotAVideo = "what it gives is no video";  // reason that open() may give
  // live: from the network; what has been decoded of a stream that comes at its own pace is given at once, and who is
  // silent for 5 s has failed. Null: it cannot be opened, or there is no video in it; `why` says which, as the end of a
  // sentence. stopped: where it is set, that ends soon, here as in grab(). Throws UserError where videos cannot be
  // decoded here.
  static std::unique_ptr<StreamDecoder> open(const std::string& url, bool live, std::string* why,
                                             const std::atomic<bool>* stopped = nullptr);
  virtual ~StreamDecoder() = default;

  // Decodes the next frame; false at the end, and when the stream has failed.
  virtual bool grab() = 0;
  // The frame that was grabbed last, in colours. Empty: it could not be decoded.
  virtual Picture bgr() = 0;
  // Time when the frame is to be shown, from the start of the stream on; empty: the container does not say.
  virtual std::optional<double> time_s() const = 0;
  // Parts of it did not arrive, or of one that it was made from: they are made up.
  virtual bool concealed() const = 0;

  // Whether the stream is a file that has an end, though it may come from the network.
  virtual bool has_end() const = 0;
  // Frame rate in the container, or where that has no times, in the frames themselves once one was grabbed; 0: not
  // known.
  virtual double rate_hz() const = 0;
  virtual std::int64_t frames() const = 0;  // number in the container; 0: not known
  virtual int videos() const = 0;           // in the container, of which one is decoded: its place from 1 on
  virtual int video() const = 0;
  // The share of the video that, as the container says, comes after the frame that was grabbed last; 0: none that is
  // worth a word, or it does not say.
  virtual double missing_share() const = 0;
  virtual int turn_deg() const = 0;  // clockwise rotation that makes frames upright: 0 to 359

  // Makes grab() return false soon after, for good; callable from any thread.
  virtual void stop() = 0;
};

}  // namespace coslam
