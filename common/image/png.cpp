// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/image/png.h"

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <string>

namespace coslam::png {
namespace {

struct Unread {
  std::span<const std::uint8_t> octets;
};

void take(png_structp png, png_bytep to, std::size_t size) {
  auto* unread = static_cast<Unread*>(png_get_io_ptr(png));
  if (size > unread->octets.size()) png_error(png, "the end is missing");
  std::memcpy(to, unread->octets.data(), size);
  unread->octets = unread->octets.subspan(size);
}

void put(png_structp png, png_bytep from, std::size_t size) {
  auto* out = static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  out->insert(out->end(), from, from + size);
}

void flush(png_structp) {}

// libpng comes back from an error by longjmp, past the frames of its own functions and these.
[[noreturn]] void fail(png_structp png, png_const_charp) { png_longjmp(png, 1); }
void ignore(png_structp, png_const_charp) {}

struct Reader {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, ignore);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  Reader() = default;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct Writer {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, ignore);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  Writer() = default;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() { png_destroy_write_struct(&png, &info); }
};

// Channels of an image with the colours that it has.
int channels_of(png_structp png, png_infop info) {
  const int colour = png_get_color_type(png, info);
  if ((colour & PNG_COLOR_MASK_ALPHA) != 0) return 4;
  if (colour == PNG_COLOR_TYPE_GRAY) return 1;
  return png_get_valid(png, info, PNG_INFO_tRNS) != 0 ? 4 : 3;
}

// Has libpng bring the pixels into that form.
void transform(png_structp png, png_infop info, int channels) {
  constexpr double kRed = 0.299, kGreen = 0.587;
  const int colour = png_get_color_type(png, info);
  const bool coloured = (colour & PNG_COLOR_MASK_COLOR) != 0;
  png_set_swap(png);
  if (channels < 4) {
    png_set_strip_alpha(png);
  } else {
    png_set_tRNS_to_alpha(png);
  }
  if (colour == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
  if (!coloured && png_get_bit_depth(png, info) < 8) png_set_expand_gray_1_2_4_to_8(png);
  if (channels == 1) {
    png_set_rgb_to_gray(png, PNG_ERROR_ACTION_NONE, kRed, kGreen);
  } else if (coloured) {
    png_set_bgr(png);
  } else {
    png_set_gray_to_rgb(png);
  }
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
}

// False: damaged. Holds nothing that a jump would leave behind.
bool read(Reader* reader, Unread* unread, Wanted wanted, cv::Mat* out, std::vector<png_bytep>* rows) {
  png_structp png = reader->png;
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_read_fn(png, unread, take);
  png_read_info(png, reader->info);
  const auto width = png_get_image_width(png, reader->info), height = png_get_image_height(png, reader->info);
  if (width > kMostImageSide || height > kMostImageSide) return false;
  const int channels = wanted == Wanted::kGrey ? 1 : channels_of(png, reader->info);
  transform(png, reader->info, channels);
  const int depth = png_get_bit_depth(png, reader->info) == 16 ? CV_16U : CV_8U;
  out->create(static_cast<int>(height), static_cast<int>(width), CV_MAKETYPE(depth, channels));
  if (png_get_rowbytes(png, reader->info) != out->elemSize() * width) return false;
  rows->resize(height);
  for (std::size_t y = 0; y < height; ++y) (*rows)[y] = out->ptr(static_cast<int>(y));
  png_read_image(png, rows->data());
  png_read_end(png, nullptr);
  return true;
}

bool write(Writer* writer, const cv::Mat& image, std::vector<std::uint8_t>* out, std::vector<png_bytep>* rows) {
  constexpr int kFastest = 1, kRunLengths = 3;  // of zlib
  png_structp png = writer->png;
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_write_fn(png, out, put, flush);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_compression_level(png, kFastest);
  png_set_compression_strategy(png, kRunLengths);
  const int channels = image.channels();
  const int colour = channels == 1   ? PNG_COLOR_TYPE_GRAY
                     : channels == 3 ? PNG_COLOR_TYPE_RGB
                                     : PNG_COLOR_TYPE_RGB_ALPHA;
  png_set_IHDR(png, writer->info, static_cast<png_uint_32>(image.cols), static_cast<png_uint_32>(image.rows),
               image.depth() == CV_8U ? 8 : 16, colour, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, writer->info);
  png_set_bgr(png);
  png_set_swap(png);
  rows->resize(static_cast<std::size_t>(image.rows));
  for (int y = 0; y < image.rows; ++y) (*rows)[static_cast<std::size_t>(y)] = const_cast<png_bytep>(image.ptr(y));
  png_write_image(png, rows->data());
  png_write_end(png, writer->info);
  return true;
}

}  // namespace

bool is_png(std::span<const std::uint8_t> octets) {
  constexpr std::size_t kSignature = 8;
  return octets.size() >= kSignature && png_sig_cmp(octets.data(), 0, kSignature) == 0;
}

cv::Mat decode(std::span<const std::uint8_t> octets, Wanted wanted) {
  Reader reader;
  if (reader.info == nullptr) return {};
  Unread unread{octets};
  cv::Mat out;
  std::vector<png_bytep> rows;
  return read(&reader, &unread, wanted, &out, &rows) ? out : cv::Mat();
}

std::vector<std::uint8_t> encode(const cv::Mat& image) {
  const int channels = image.channels();
  if (image.empty() || image.depth() > CV_16U || image.depth() == CV_8S || channels == 2 || channels > 4) return {};
  Writer writer;
  std::vector<std::uint8_t> out;
  std::vector<png_bytep> rows;
  if (writer.info == nullptr || !write(&writer, image, &out, &rows)) out.clear();
  return out;
}

}  // namespace coslam::png
