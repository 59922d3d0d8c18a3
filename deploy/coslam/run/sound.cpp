// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/sound.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <opencv2/core.hpp>

#include "common/video/video_codecs.h"

namespace coslam {
namespace {

constexpr double kLeast_s = 1;
// Speech, steps and clatter; below it wind and the hum of the mains, above it nothing that a small microphone hears
// from afar.
constexpr double kLowest_hz = 150, kHighest_hz = 3600;
// The highest of a few million peaks of noise is 5.5 of its standard deviations high.
constexpr double kOfNoise = 9;
constexpr double kAlikeElsewhere = 0.7;  // of how much they are alike
constexpr double kElsewhere_s = 0.1;
constexpr double kFade_s = 1;
// Clocks of recorders differ by tens of millionths: what lasts longer does not fit as a whole.
constexpr double kBlock_s = 25;
constexpr std::size_t kMostBlocks = 8;

// The spectrum of what can be heard of a recording. Its ends fade: where it stops is no sound.
cv::Mat in_band(std::span<const float> samples, int length, double rate_hz) {
  cv::Mat padded = cv::Mat::zeros(1, length, CV_32F);
  auto* to = padded.ptr<float>();
  std::ranges::copy(samples, to);
  const std::size_t fade = std::min(samples.size() / 8, static_cast<std::size_t>(kFade_s * rate_hz));
  for (std::size_t i = 0; i < fade; ++i) {
    const auto gain =
        static_cast<float>(0.5 - 0.5 * std::cos(M_PI * static_cast<double>(i) / static_cast<double>(fade)));
    to[i] *= gain;
    to[samples.size() - 1 - i] *= gain;
  }
  cv::Mat out;
  cv::dft(padded, out, cv::DFT_COMPLEX_OUTPUT);
  for (int k = 0; k < length; ++k) {
    const double frequency_hz = rate_hz * std::min(k, length - k) / length;
    if (frequency_hz < kLowest_hz || frequency_hz > kHighest_hz) out.at<std::complex<float>>(k) = 0;
  }
  return out;
}

// Energy of the samples before each.
std::vector<double> energy_before(const cv::Mat& samples, std::size_t n) {
  std::vector<double> out(n + 1, 0);
  const auto* s = samples.ptr<float>();
  for (std::size_t i = 0; i < n; ++i) out[i + 1] = out[i] + static_cast<double>(s[i]) * s[i];
  return out;
}

cv::Mat back(const cv::Mat& spectrum) {
  cv::Mat out;
  cv::dft(spectrum, out, cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT | cv::DFT_SCALE);
  return out;
}

// Whether two recordings are alike at another lag too, as those of music that repeats itself: their plain correlation,
// as a share of what those parts have that overlap there.
bool repeats(const cv::Mat& a, std::size_t of_a, const cv::Mat& b, std::size_t of_b, const cv::Mat& correlation,
             int best, int away, std::size_t least) {
  const std::vector<double> before_a = energy_before(a, of_a), before_b = energy_before(b, of_b);
  const int length = correlation.cols;
  const auto share = [&](int lag) {
    const auto from = static_cast<std::size_t>(std::max(0, lag)), skipped = static_cast<std::size_t>(std::max(0, -lag));
    if (from >= of_a || skipped >= of_b) return 0.0;
    const std::size_t overlap = std::min(of_a - from, of_b - skipped);
    if (overlap < least) return 0.0;
    const double energy2 =
        (before_a[from + overlap] - before_a[from]) * (before_b[skipped + overlap] - before_b[skipped]);
    return energy2 > 0 ? correlation.at<float>((lag + length) % length) / std::sqrt(energy2) : 0.0;
  };
  const double at_best = share(best);
  for (int lag = -static_cast<int>(of_b); lag < static_cast<int>(of_a); ++lag) {
    if (std::abs(lag - best) > away && share(lag) > kAlikeElsewhere * at_best) return true;
  }
  return false;
}

std::optional<double> later_as_a_whole_s(std::span<const float> first, std::span<const float> second, double rate_hz) {
  const auto least = static_cast<std::size_t>(kLeast_s * rate_hz);
  if (first.size() < least || second.size() < least) return std::nullopt;
  const int length = cv::getOptimalDFTSize(static_cast<int>(first.size() + second.size()));
  cv::Mat a = in_band(first, length, rate_hz), b = in_band(second, length, rate_hz), whitened(1, length, CV_32FC2),
          plain(1, length, CV_32FC2);
  for (int k = 0; k < length; ++k) {
    const std::complex<float> x = a.at<std::complex<float>>(k) * std::conj(b.at<std::complex<float>>(k));
    plain.at<std::complex<float>>(k) = x;
    const float size = std::abs(x);
    whitened.at<std::complex<float>>(k) = size == 0 ? 0 : x / size;
  }
  const cv::Mat correlation = back(whitened);
  cv::Scalar mean, deviation;
  cv::meanStdDev(correlation, mean, deviation);
  const auto* values = correlation.ptr<float>();
  const int peak = static_cast<int>(std::max_element(values, values + length) - values);
  if (!(values[peak] > kOfNoise * deviation[0])) return std::nullopt;
  const int best = peak >= static_cast<int>(first.size()) ? peak - length : peak;  // negative lags lie behind
  const auto away = static_cast<int>(kElsewhere_s * rate_hz);
  if (repeats(back(a), first.size(), back(b), second.size(), back(plain), best, away, least)) return std::nullopt;
  return best / rate_hz;
}

}  // namespace

std::optional<Sound> sound_of(const std::filesystem::path& video) {
  const VideoCodecs* codecs = video_codecs_if_any();
  return codecs == nullptr ? std::nullopt : codecs->sound_of(video);
}

std::optional<double> began_later_s(std::span<const float> first, std::span<const float> second, double rate_hz) {
  const auto block = static_cast<std::size_t>(kBlock_s * rate_hz);
  if (second.size() <= 2 * block) return later_as_a_whole_s(first, second, rate_hz);
  const std::size_t blocks = std::min(kMostBlocks, second.size() / block);
  for (std::size_t i = 0; i < blocks; ++i) {
    const std::size_t from = i * (second.size() - block) / (blocks - 1);
    const auto later_s = later_as_a_whole_s(first, second.subspan(from, block), rate_hz);
    if (later_s) return *later_s - static_cast<double>(from) / rate_hz;
  }
  return std::nullopt;
}

}  // namespace coslam
