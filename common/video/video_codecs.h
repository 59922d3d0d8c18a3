// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/video/image_form.h"
#include "common/video/picture.h"
#include "common/video/sound.h"
#include "common/video/stream_decoder.h"
#include "common/video/video_packets.h"

namespace coslam {

// Decodes videos, streams and further image files, by FFmpeg. The implementation lies in a file of its own beside the
// programs, which is loaded when it is first needed, because FFmpeg is many times larger than an agent.
class VideoCodecs {
 public:
  static constexpr const char* kPlugIn = "coslam-video";

  virtual ~VideoCodecs() = default;
  // Does what StreamDecoder::open() says.
  virtual std::unique_ptr<StreamDecoder> open_stream(const std::string& url, bool live, std::string* why,
                                                     const std::atomic<bool>* stopped) const = 0;
  // Does what VideoPackets::for_codec() says, by FFmpeg's name of the codec.
  virtual std::unique_ptr<VideoPackets> packets_of(std::string_view codec) const = 0;
  // Decodes an image file into a picture that visit() sees; false: it cannot be read.
  virtual bool decode_image(std::span<const std::uint8_t> octets, const ImageForm& form,
                            const std::function<void(const Picture&)>& visit) const = 0;
  // The focal length that a video notes about itself, in millimetres on 35 mm film.
  virtual std::optional<double> noted_film_mm(const std::filesystem::path& video) const = 0;
  // The first ten minutes of its sound; empty: there is none, or none that can be read.
  virtual std::optional<Sound> sound_of(const std::filesystem::path& video) const = 0;
};

// Throws UserError where it is not installed, with the package that brings it.
const VideoCodecs& video_codecs();
// Null: it is not installed; then why_no_video_codecs() is a sentence about it.
const VideoCodecs* video_codecs_if_any();
const std::string& why_no_video_codecs();

}  // namespace coslam
