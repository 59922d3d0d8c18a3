// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <opencv2/videoio.hpp>
#include <random>
#include <vector>

#include "tests/support/video_with_sound.h"

namespace coslam::test {

// What one place sounds like at an instant: a tone for each twentieth of a second, of its own pitch and strength, so
// that any rate can sample it.
inline double world_sound(double t_s) {
  double sum = 0;
  const auto slot = static_cast<std::int64_t>(std::floor(t_s * 20));
  for (std::int64_t s = slot - 1; s <= slot; ++s) {
    std::mt19937_64 random(static_cast<std::uint64_t>(s + 1'000'000));
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int tone = 0; tone < 4; ++tone) {
      const double pitch_hz = 200 + 3000 * uniform(random), strength = 0.1 * uniform(random);
      const double x = t_s * 20 - static_cast<double>(s);  // 0 to 2
      sum += strength * std::sin(0.5 * M_PI * x) * std::sin(2 * M_PI * pitch_hz * t_s);
    }
  }
  return sum;
}

// By a microphone with noise of its own that began to listen at an instant.
inline std::vector<float> heard(int rate_hz, double from_s, double seconds, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, 0.05);
  std::vector<float> out(static_cast<std::size_t>(seconds * rate_hz));
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<float>(world_sound(from_s + static_cast<double>(i) / rate_hz) + noise(random));
  return out;
}

// A film of a few grey images, with that sound.
inline void write_film(const std::filesystem::path& file, const std::vector<float>& samples, int rate_hz,
                       double sound_later_s = 0) {
  const std::filesystem::path mute = file.string() + ".mute.mp4";
  {
    cv::VideoWriter writer(mute.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 20, {64, 48});
    for (int i = 0; i < 60; ++i) writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(4 * i)));
  }
  add_sound(mute, file, samples, rate_hz, sound_later_s);
}

}  // namespace coslam::test
