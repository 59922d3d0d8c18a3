// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace coslam {

// The forms of image files besides PNG and JPEG, by how they begin.
struct ImageForm {
  std::string_view begins;
  const char* decoder;  // FFmpeg's name of it
};

inline constexpr std::array kImageForms = std::to_array<ImageForm>({
    {"BM", "bmp"},
    {std::string_view("II*\0", 4), "tiff"},
    {std::string_view("MM\0*", 4), "tiff"},
    {std::string_view("\0\0\0\x0cjP  ", 8), "jpeg2000"},
    {"\xff\x4f\xff\x51", "jpeg2000"},
    {"RIFF", "webp"},
    {"P1", "pbm"},
    {"P2", "pgm"},
    {"P3", "ppm"},
    {"P4", "pbm"},
    {"P5", "pgm"},
    {"P6", "ppm"},
    {"P7", "pam"},
    {"\x59\xa6\x6a\x95", "sunrast"},
});

// Null: none of them.
inline const ImageForm* form_of(std::span<const std::uint8_t> octets) {
  const std::string_view text(reinterpret_cast<const char*>(octets.data()), octets.size());
  const auto* form = std::ranges::find_if(kImageForms, [&](const ImageForm& f) { return text.starts_with(f.begins); });
  return form == kImageForms.end() ? nullptr : form;
}

}  // namespace coslam
