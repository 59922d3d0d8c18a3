// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/encodings.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace coslam {
namespace {

constexpr int kAsItIs = -1;

struct Encoding {
  std::string_view name;
  int bits = 8;           // a value
  int channels = 1;       // values a pixel, of the first plane
  int to_grey = kAsItIs;  // of OpenCV
  int luma = -1;          // the value of a pixel that is its luma already
};

constexpr std::array kEncodings = std::to_array<Encoding>({
    {"mono8"},
    {"8UC1"},
    {"mono16", 16},
    {"16UC1", 16},
    {"rgb8", 8, 3, cv::COLOR_RGB2GRAY},
    {"bgr8", 8, 3, cv::COLOR_BGR2GRAY},
    {"8UC3", 8, 3, cv::COLOR_BGR2GRAY},
    {"rgba8", 8, 4, cv::COLOR_RGBA2GRAY},
    {"bgra8", 8, 4, cv::COLOR_BGRA2GRAY},
    {"8UC4", 8, 4, cv::COLOR_BGRA2GRAY},
    {"rgb16", 16, 3, cv::COLOR_RGB2GRAY},
    {"bgr16", 16, 3, cv::COLOR_BGR2GRAY},
    {"rgba16", 16, 4, cv::COLOR_RGBA2GRAY},
    {"bgra16", 16, 4, cv::COLOR_BGRA2GRAY},
    // OpenCV names a pattern by the second and third pixel of its second row.
    {"bayer_rggb8", 8, 1, cv::COLOR_BayerBG2GRAY},
    {"bayer_bggr8", 8, 1, cv::COLOR_BayerRG2GRAY},
    {"bayer_gbrg8", 8, 1, cv::COLOR_BayerGR2GRAY},
    {"bayer_grbg8", 8, 1, cv::COLOR_BayerGB2GRAY},
    {"bayer_rggb16", 16, 1, cv::COLOR_BayerBG2GRAY},
    {"bayer_bggr16", 16, 1, cv::COLOR_BayerRG2GRAY},
    {"bayer_gbrg16", 16, 1, cv::COLOR_BayerGR2GRAY},
    {"bayer_grbg16", 16, 1, cv::COLOR_BayerGB2GRAY},
    {"yuv422_yuy2", 8, 2, kAsItIs, 0},
    {"yuyv", 8, 2, kAsItIs, 0},
    {"yuv422", 8, 2, kAsItIs, 1},
    {"uyvy", 8, 2, kAsItIs, 1},
    // Planes of luma first; colours follow.
    {"nv12"},
    {"nv21"},
    {"nv24"},
    {"i420"},
    {"yuv420p"},
    {"yv12"},
});

const Encoding* find(std::string_view name) {
  const auto at = std::ranges::find(kEncodings, name, &Encoding::name);
  return at == kEncodings.end() ? nullptr : &*at;
}

std::size_t octets_of_row(const Encoding& encoding, std::size_t width_px) {
  return width_px * static_cast<std::size_t>(encoding.channels * encoding.bits / 8);
}

// Of a row, in one order of octets; none where it is short.
std::vector<double> values_of_row(const RawImage& image, const Encoding& encoding, std::size_t y, bool big_endian) {
  const std::size_t row = octets_of_row(encoding, image.width_px), at = y * image.octets_per_row;
  if (image.octets_per_row < row || at + row > image.octets.size()) return {};
  // Of a pattern of colours every second pixel has the same.
  const auto step = static_cast<std::size_t>(4 * encoding.channels);
  std::vector<double> values;
  for (std::size_t i = at; i + 2 <= at + row; i += step) {
    const unsigned first = image.octets[i], second = image.octets[i + 1];
    values.push_back(big_endian ? first << 8U | second : second << 8U | first);
  }
  return values;
}

// By how much neighbours differ, as a share of how much any two do; 0 where all are alike.
double roughness(const RawImage& image, const Encoding& encoding, bool big_endian) {
  constexpr std::size_t kRows = 32;
  double neighbours = 0, any = 0;
  for (std::size_t y = 0; y < image.height_px; y += std::max<std::size_t>(1, image.height_px / kRows)) {
    const std::vector<double> values = values_of_row(image, encoding, y, big_endian);
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
      neighbours += std::abs(values[i + 1] - values[i]);
      any += std::abs(values[(i + values.size() / 2) % values.size()] - values[i]);
    }
  }
  return any > 0 ? neighbours / any : 0;
}

void swap_octets(cv::Mat* image) {
  for (int y = 0; y < image->rows; ++y) {
    auto* at = image->ptr<std::uint16_t>(y);
    for (int i = 0; i < image->cols * image->channels(); ++i)
      at[i] = static_cast<std::uint16_t>(at[i] << 8 | at[i] >> 8);
  }
}

}  // namespace

cv::Mat grey_of(const RawImage& image) {
  constexpr std::size_t kMost = 1U << 15U;
  const Encoding* e = find(image.encoding);
  if (e == nullptr || image.width_px == 0 || image.height_px == 0 || image.width_px > kMost || image.height_px > kMost)
    return {};
  const std::size_t row = octets_of_row(*e, image.width_px);
  const std::size_t step = image.octets_per_row;
  if (step < row || step > image.octets.size() || image.octets.size() - row < step * (image.height_px - 1)) return {};
  const cv::Size size(static_cast<int>(image.width_px), static_cast<int>(image.height_px));
  cv::Mat pixels;
  if (e->bits == 8) {
    pixels = cv::Mat(size, CV_MAKETYPE(CV_8U, e->channels), const_cast<std::uint8_t*>(image.octets.data()), step);
  } else {  // values of 16 bits need not lie at even addresses there
    pixels.create(size, CV_MAKETYPE(CV_16U, e->channels));
    for (int y = 0; y < size.height; ++y) {
      std::memcpy(pixels.ptr(y), image.octets.data() + static_cast<std::size_t>(y) * step, row);
    }
  }
  const bool swapped = image.big_endian != (std::endian::native == std::endian::big);
  if (e->bits == 16 && swapped) swap_octets(&pixels);
  cv::Mat grey;
  if (e->luma >= 0) {
    cv::extractChannel(pixels, grey, e->luma);
  } else if (e->to_grey != kAsItIs) {
    try {
      cv::cvtColor(pixels, grey, e->to_grey);
    } catch (const cv::Exception&) {
      return {};  // it is smaller than its pattern of colours
    }
  } else {
    grey = e->bits == 8 ? pixels.clone() : pixels;
  }
  return grey;
}

bool OctetOrder::is_wrong_in(const RawImage& image) {
  constexpr double kMuch = 2;
  const Encoding* e = find(image.encoding);
  if (wrong_ || e == nullptr || e->bits != 16) return is_wrong();
  const double as_said = roughness(image, *e, image.big_endian), other = roughness(image, *e, !image.big_endian);
  if (as_said > kMuch * other && other > 0) wrong_ = true;
  if (other > kMuch * as_said && as_said > 0) wrong_ = false;
  return is_wrong();
}

std::string why_not_grey(const RawImage& image) {
  const Encoding* e = find(image.encoding);
  const std::string encoding(image.encoding);
  if (encoding.starts_with("32F") || encoding.starts_with("64F")) {
    return "its encoding is " + encoding +
           ", as of depth or heat: record the camera's picture, or what a node makes of these as mono16";
  }
  if (e == nullptr) return "its encoding is " + encoding + ", known are " + known_encodings();
  if (image.octets_per_row < octets_of_row(*e, image.width_px)) {
    return "its rows have " + std::to_string(image.octets_per_row) + " octets (step), and " +
           std::to_string(image.width_px) + " pixels of " + encoding + " need " +
           std::to_string(octets_of_row(*e, image.width_px));
  }
  return "it has " + std::to_string(image.octets.size()) + " octets, and " + std::to_string(image.height_px) +
         " rows of " + std::to_string(image.octets_per_row) + " are needed";
}

bool is_known_encoding(std::string_view encoding) { return find(encoding) != nullptr; }

std::string known_encodings() {
  std::string out;
  for (const Encoding& e : kEncodings) {
    if (!out.empty()) out += &e == &kEncodings.back() ? " and " : ", ";
    out += e.name;
  }
  return out;
}

}  // namespace coslam
