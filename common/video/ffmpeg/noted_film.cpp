// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
extern "C" {
#include <libavformat/avformat.h>
}

#include <charconv>
#include <memory>
#include <string>
#include <string_view>

#include "common/base/words.h"
#include "common/video/ffmpeg/owned.h"
#include "common/video/ffmpeg/plug_in.h"
#include "common/video/ffmpeg/quiet_ffmpeg.h"

namespace coslam {
namespace {

// com.apple.quicktime.camera.focal_length.35mm_equivalent, and what others call like it.
std::optional<double> film_mm_of(const AVDictionary* noted) {
  const AVDictionaryEntry* entry = nullptr;
  while ((entry = av_dict_get(noted, "", entry, AV_DICT_IGNORE_SUFFIX)) != nullptr) {
    if (!lower(entry->key).ends_with("focal_length.35mm_equivalent")) continue;
    const std::string_view value = entry->value;
    double film_mm = 0;
    const auto read = std::from_chars(value.data(), value.data() + value.size(), film_mm);
    if (read.ec == std::errc() && film_mm > 0) return film_mm;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> ffmpeg::noted_film_mm(const std::filesystem::path& video) {
  const QuietFfmpeg quiet;
  AVFormatContext* opened = nullptr;
  if (avformat_open_input(&opened, video.c_str(), nullptr, nullptr) != 0) return std::nullopt;
  const ffmpeg::Container container(opened);
  std::optional<double> film_mm = film_mm_of(container->metadata);
  for (unsigned i = 0; !film_mm && i < container->nb_streams; ++i)
    film_mm = film_mm_of(container->streams[i]->metadata);
  return film_mm;
}

}  // namespace coslam
