// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/image/jpeg.h"

#include <csetjmp>
#include <cstdio>
#include <cstdlib>
// After cstdio, which it needs.
#include <jpeglib.h>

namespace coslam::jpeg {
namespace {

// libjpeg comes back from an error by longjmp, past the frames of its own functions.
struct Errors : jpeg_error_mgr {
  std::jmp_buf back;
};

[[noreturn]] void fail(j_common_ptr codec) { std::longjmp(static_cast<Errors*>(codec->err)->back, 1); }
void ignore(j_common_ptr) {}

jpeg_error_mgr* install(Errors* errors) {
  jpeg_std_error(errors);
  errors->error_exit = fail;
  errors->output_message = ignore;
  return errors;
}

struct Reader {
  Errors errors{};
  jpeg_decompress_struct codec{};
  Reader() = default;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { jpeg_destroy_decompress(&codec); }
};

struct Writer {
  Errors errors{};
  jpeg_compress_struct codec{};
  unsigned char* octets = nullptr;
  unsigned long size = 0;
  Writer() = default;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() {
    jpeg_destroy_compress(&codec);
    std::free(octets);
  }
};

// False: damaged. Holds nothing that a jump would leave behind.
bool read(Reader* reader, std::span<const std::uint8_t> octets, Wanted wanted, cv::Mat* out) {
  constexpr int kForPrint = 4;
  jpeg_decompress_struct* codec = &reader->codec;
  codec->err = install(&reader->errors);
  if (setjmp(reader->errors.back) != 0) return false;
  jpeg_create_decompress(codec);
  jpeg_mem_src(codec, octets.data(), octets.size());
  jpeg_read_header(codec, TRUE);
  if (codec->num_components == kForPrint || codec->image_width > kMostImageSide ||
      codec->image_height > kMostImageSide) {
    return false;
  }
  const bool grey = wanted == Wanted::kGrey || codec->num_components == 1;
  codec->out_color_space = grey ? JCS_GRAYSCALE : JCS_EXT_BGR;
  jpeg_start_decompress(codec);
  out->create(static_cast<int>(codec->output_height), static_cast<int>(codec->output_width), grey ? CV_8UC1 : CV_8UC3);
  while (codec->output_scanline < codec->output_height) {
    JSAMPROW row = out->ptr(static_cast<int>(codec->output_scanline));
    jpeg_read_scanlines(codec, &row, 1);
  }
  jpeg_finish_decompress(codec);
  return true;
}

bool write(Writer* writer, const cv::Mat& image, int quality, bool optimize) {
  jpeg_compress_struct* codec = &writer->codec;
  codec->err = install(&writer->errors);
  if (setjmp(writer->errors.back) != 0) return false;
  jpeg_create_compress(codec);
  jpeg_mem_dest(codec, &writer->octets, &writer->size);
  codec->image_width = static_cast<JDIMENSION>(image.cols);
  codec->image_height = static_cast<JDIMENSION>(image.rows);
  codec->input_components = image.channels();
  codec->in_color_space = image.channels() == 1 ? JCS_GRAYSCALE : JCS_EXT_BGR;
  jpeg_set_defaults(codec);
  jpeg_set_quality(codec, quality, TRUE);
  codec->optimize_coding = optimize ? TRUE : FALSE;
  jpeg_start_compress(codec, TRUE);
  while (codec->next_scanline < codec->image_height) {
    auto* row = const_cast<JSAMPROW>(image.ptr(static_cast<int>(codec->next_scanline)));
    jpeg_write_scanlines(codec, &row, 1);
  }
  jpeg_finish_compress(codec);
  return true;
}

}  // namespace

bool is_jpeg(std::span<const std::uint8_t> octets) {
  return octets.size() > 3 && octets[0] == 0xff && octets[1] == 0xd8 && octets[2] == 0xff;
}

cv::Mat decode(std::span<const std::uint8_t> octets, Wanted wanted) {
  Reader reader;
  cv::Mat out;
  return read(&reader, octets, wanted, &out) ? out : cv::Mat();
}

std::vector<std::uint8_t> encode(const cv::Mat& image, int quality, bool optimize) {
  if (image.empty() || (image.type() != CV_8UC1 && image.type() != CV_8UC3)) return {};
  Writer writer;
  if (!write(&writer, image, quality, optimize)) return {};
  return {writer.octets, writer.octets + writer.size};
}

}  // namespace coslam::jpeg
