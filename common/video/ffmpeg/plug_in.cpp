// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/video/ffmpeg/plug_in.h"

namespace coslam {
namespace {

class FfmpegCodecs final : public VideoCodecs {
 public:
  std::unique_ptr<StreamDecoder> open_stream(const std::string& url, bool live, std::string* why,
                                             const std::atomic<bool>* stopped) const override {
    return ffmpeg::open_stream(url, live, why, stopped);
  }
  std::unique_ptr<VideoPackets> packets_of(std::string_view codec) const override { return ffmpeg::packets_of(codec); }
  bool decode_image(std::span<const std::uint8_t> octets, const ImageForm& form,
                    const std::function<void(const Picture&)>& visit) const override {
    return ffmpeg::decode_image(octets, form, visit);
  }
  std::optional<double> noted_film_mm(const std::filesystem::path& video) const override {
    return ffmpeg::noted_film_mm(video);
  }
  std::optional<Sound> sound_of(const std::filesystem::path& video) const override { return ffmpeg::sound_of(video); }
};

}  // namespace
}  // namespace coslam

extern "C" __attribute__((visibility("default"))) const void* coslam_plug_in(const char* version) {
  static const coslam::FfmpegCodecs codecs;
  return std::string_view(version) == COSLAM_VERSION ? static_cast<const coslam::VideoCodecs*>(&codecs) : nullptr;
}
