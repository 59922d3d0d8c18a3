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

#include "common/video/video_codecs.h"

// The functions of VideoCodecs.
namespace coslam::ffmpeg {

std::unique_ptr<StreamDecoder> open_stream(const std::string& url, bool live, std::string* why,
                                           const std::atomic<bool>* stopped);
std::unique_ptr<VideoPackets> packets_of(std::string_view codec);
bool decode_image(std::span<const std::uint8_t> octets, const ImageForm& form,
                  const std::function<void(const Picture&)>& visit);
std::optional<double> noted_film_mm(const std::filesystem::path& video);
std::optional<Sound> sound_of(const std::filesystem::path& video);

}  // namespace coslam::ffmpeg
