// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <string_view>

#include "common/video/picture.h"

namespace coslam {

// A running pipeline of GStreamer. For one thread.
class Pipeline {
 public:
  // A picture as the pipeline gives it.
  struct Raw {
    Picture first_plane;        // width, height, length of rows and pixels
    std::size_t octets = 0;     // length of all planes
    std::string_view encoding;  // name that grey_of() knows; empty: another format
    std::string_view format;    // name that GStreamer has for it
  };

  virtual ~Pipeline() = default;
  // The next picture; false at the end, and when the pipeline has failed.
  virtual bool read(Raw* picture) = 0;
};

// Starts pipelines, by GStreamer, in a file of its own as VideoCodecs is.
class Pipelines {
 public:
  static constexpr const char* kPlugIn = "coslam-gstreamer";

  virtual ~Pipelines() = default;
  // Starts a pipeline in the words of gst-launch, with an element appsink. Null: it cannot be; why, as the end of a
  // sentence. stopped: where it is set, read() ends soon.
  virtual std::unique_ptr<Pipeline> start(const std::string& words, std::string* why,
                                          const std::atomic<bool>& stopped) const = 0;
};

// Throws UserError where it is not installed, with the package that brings it.
const Pipelines& pipelines();

}  // namespace coslam
