// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/image/image_file.h"

#include <fstream>
#include <iterator>
#include <mutex>
#include <opencv2/imgproc.hpp>

#include "common/base/log.h"
#include "common/base/words.h"
#include "common/image/cut_off.h"
#include "common/image/jpeg.h"
#include "common/image/png.h"
#include "common/video/video_codecs.h"

namespace coslam {
namespace {

cv::Mat decode_by_ffmpeg(std::span<const std::uint8_t> octets, const ImageForm& form) {
  const VideoCodecs* codecs = video_codecs_if_any();
  if (codecs == nullptr) {
    static std::once_flag once;
    std::call_once(once, [] { log_warn(why_no_video_codecs()); });
    return {};
  }
  cv::Mat out;
  codecs->decode_image(octets, form, [&](const Picture& picture) { out = mat_of(picture); });
  return out;
}

cv::Mat decode(std::span<const std::uint8_t> octets, Wanted wanted) {
  if (octets.empty() || is_cut_off(octets)) return {};
  if (png::is_png(octets)) return png::decode(octets, wanted);
  if (jpeg::is_jpeg(octets)) return jpeg::decode(octets, wanted);
  const ImageForm* form = form_of(octets);
  if (form == nullptr) return {};
  const cv::Mat image = decode_by_ffmpeg(octets, *form);
  if (wanted == Wanted::kUnchanged || image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace

cv::Mat decode_grey(std::span<const std::uint8_t> octets) { return decode(octets, Wanted::kGrey); }
cv::Mat decode_unchanged(std::span<const std::uint8_t> octets) { return decode(octets, Wanted::kUnchanged); }

std::vector<std::uint8_t> read_octets(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

bool write_image_file(const std::filesystem::path& file, const cv::Mat& image) {
  constexpr int kGood = 95;
  const std::string kind = lower(file.extension().string());
  std::vector<std::uint8_t> octets;
  if (kind == ".png") octets = png::encode(image);
  if (kind == ".jpg" || kind == ".jpeg") octets = jpeg::encode(image, kGood, false);
  if (octets.empty()) return false;
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(octets.data()), static_cast<std::streamsize>(octets.size()));
  out.flush();
  return out.good();
}

std::vector<std::uint8_t> encode_jpeg(const cv::Mat& image, int quality, bool optimize) {
  return jpeg::encode(image, quality, optimize);
}

cv::Mat mat_of(const Picture& picture) {
  if (picture.empty()) return {};
  const int type = CV_MAKETYPE(picture.octets_per_value == 2 ? CV_16U : CV_8U, picture.channels);
  return cv::Mat(picture.height_px, picture.width_px, type, const_cast<std::uint8_t*>(picture.pixels),
                 picture.octets_per_row)
      .clone();
}

}  // namespace coslam
