// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/noted_focal.h"

#include <libexif/exif-data.h>
#include <libexif/exif-utils.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "common/video/video_codecs.h"

namespace coslam {
namespace {

using Exif = std::unique_ptr<ExifData, decltype([](ExifData* data) { exif_data_unref(data); })>;

// Of a length in millimetres on 35 mm film, which goes by the diagonal.
double focal_px_of_film(double focal_mm, int width_px, int height_px) {
  const double diagonal_mm = std::hypot(36, 24);
  return focal_mm / diagonal_mm * std::hypot(width_px, height_px);
}

// Of whatever type the entry is; 0: it is not there, or not a number.
double number(ExifData* exif, ExifTag tag) {
  ExifEntry* entry = exif_data_get_entry(exif, tag);
  if (entry == nullptr || entry->components < 1 || entry->data == nullptr) return 0;
  const ExifByteOrder order = exif_data_get_byte_order(exif);
  if (entry->size < exif_format_get_size(entry->format)) return 0;
  switch (entry->format) {
    case EXIF_FORMAT_SHORT:
      return exif_get_short(entry->data, order);
    case EXIF_FORMAT_LONG:
      return exif_get_long(entry->data, order);
    case EXIF_FORMAT_RATIONAL: {
      const ExifRational r = exif_get_rational(entry->data, order);
      return r.denominator == 0 ? 0 : static_cast<double>(r.numerator) / r.denominator;
    }
    default:
      return 0;
  }
}

// Sensor pixels a millimetre, of an image that was not made smaller since.
double pixels_a_mm(ExifData* exif, int width_px) {
  constexpr double kInch = 2, kCentimetre = 3, kMillimetre = 4;
  const double unit = number(exif, EXIF_TAG_FOCAL_PLANE_RESOLUTION_UNIT);
  const double unit_mm = unit == kCentimetre ? 10 : unit == kMillimetre ? 1 : unit == kInch || unit == 0 ? 25.4 : 0;
  if (unit_mm == 0) return 0;
  const double per_mm = number(exif, EXIF_TAG_FOCAL_PLANE_X_RESOLUTION) / unit_mm;
  const double taken_px = number(exif, EXIF_TAG_PIXEL_X_DIMENSION);
  return taken_px > 0 ? per_mm * width_px / taken_px : per_mm;
}

std::optional<double> of_exif(ExifData* exif, int width_px, int height_px) {
  if (const double film_mm = number(exif, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM); film_mm > 0)
    return focal_px_of_film(film_mm, width_px, height_px);
  const double focal_px = number(exif, EXIF_TAG_FOCAL_LENGTH) * pixels_a_mm(exif, width_px);
  return focal_px > 0 ? std::optional(focal_px) : std::nullopt;
}

std::optional<double> of_container(const std::filesystem::path& video, int width_px, int height_px) {
  const VideoCodecs* codecs = video_codecs_if_any();
  const auto film_mm = codecs == nullptr ? std::nullopt : codecs->noted_film_mm(video);
  return film_mm ? std::optional(focal_px_of_film(*film_mm, width_px, height_px)) : std::nullopt;
}

}  // namespace

std::optional<double> noted_focal_px(const std::filesystem::path& file, int width_px, int height_px) {
  const Exif exif(exif_data_new_from_file(file.c_str()));
  const auto focal_px = exif ? of_exif(exif.get(), width_px, height_px) : std::nullopt;
  const auto noted_px = focal_px ? focal_px : of_container(file, width_px, height_px);
  // From a fisheye to a long telephoto.
  const double widest = 0.2, longest = 20, longer_px = std::max(width_px, height_px);
  if (noted_px && (*noted_px < widest * longer_px || *noted_px > longest * longer_px)) return std::nullopt;
  return noted_px;
}

}  // namespace coslam
