// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The tracker against OpenCV's bare Lucas-Kanade on the same 300 points of the same images, one thread. The images are
// a textured plane under a camera that moves, turns, zooms and changes its exposure, or, if the environment variable
// COSLAM_BENCHMARK_IMAGES names a folder, the first 200 images in it.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/video/tracking.hpp>
#include <string>
#include <vector>

#include "agent/track/tracker.h"
#include "tests/support/synthetic_view.h"

namespace coslam {
namespace {

constexpr std::size_t kImages = 120;
constexpr std::size_t kMostFiles = 200;

std::vector<cv::Mat> images_in(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<cv::Mat> images;
  for (const std::string& file : files) {
    if (images.size() == kMostFiles) break;
    const cv::Mat image = cv::imread(file, cv::IMREAD_GRAYSCALE);
    if (!image.empty()) images.push_back(image);
  }
  return images;
}

// A closed path, so that the sequence can be repeated without a jump.
std::vector<cv::Mat> rendered_images() {
  const cv::Size size(640, 480);
  const cv::Mat texture = test::plane_texture(1400, 1100, 1);
  std::vector<cv::Mat> images;
  for (std::size_t i = 0; i < kImages; ++i) {
    const double a = 2 * CV_PI * static_cast<double>(i) / kImages;
    images.push_back(test::render(texture, test::view_on_loop(a, {200, 120}, 0.3, 0.2, size), size, i + 1));
  }
  return images;
}

// The images, and for each the places of the tracks that lived in it.
struct Sequence {
  std::vector<cv::Mat> images;
  std::vector<std::vector<cv::Point2f>> points;

  static const Sequence& get() {
    static const Sequence sequence;
    return sequence;
  }

 private:
  Sequence() {
    cv::setNumThreads(1);
    const char* folder = std::getenv("COSLAM_BENCHMARK_IMAGES");  // NOLINT(concurrency-mt-unsafe): before any thread
    images = folder != nullptr ? images_in(folder) : rendered_images();
    Tracker tracker({});
    for (const cv::Mat& image : images) {
      std::vector<cv::Point2f>& places = points.emplace_back();
      for (const Track& t : tracker.step(image)) places.emplace_back(t.raw_px.x(), t.raw_px.y());
    }
  }
};

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// From image i - 1 to image i, as OpenCV does it by default: window 21, 4 levels, pyramids built inside.
void opencv_step(const Sequence& s, std::size_t i) {
  if (s.points[i - 1].empty()) return;
  std::vector<cv::Point2f> found;
  std::vector<unsigned char> status;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(s.images[i - 1], s.images[i], s.points[i - 1], found, status, error);
  benchmark::DoNotOptimize(found.data());
}

void BM_OpenCvLucasKanade(benchmark::State& state) {
  const Sequence& s = Sequence::get();
  std::size_t i = 0;
  while (state.KeepRunning()) {
    i = i % (s.images.size() - 1) + 1;
    opencv_step(s, i);
  }
}
BENCHMARK(BM_OpenCvLucasKanade)->Unit(benchmark::kMillisecond);

void BM_TrackerStep(benchmark::State& state) {
  const Sequence& s = Sequence::get();
  Tracker tracker({});
  tracker.step(s.images[0]);
  std::size_t i = 0;
  while (state.KeepRunning()) {
    i = i % (s.images.size() - 1) + 1;
    benchmark::DoNotOptimize(tracker.step(s.images[i]).data());
  }
}
BENCHMARK(BM_TrackerStep)->Unit(benchmark::kMillisecond);

// Both in turn on each image, so that whatever else the machine does weighs on both alike: the ratio that counts.
void BM_TrackerOverOpenCv(benchmark::State& state) {
  const Sequence& s = Sequence::get();
  Tracker tracker({});
  tracker.step(s.images[0]);
  double opencv_s = 0, tracker_s = 0, tracks = 0;
  std::size_t i = 0;
  while (state.KeepRunning()) {
    i = i % (s.images.size() - 1) + 1;
    const double start = cpu_s();
    opencv_step(s, i);
    const double middle = cpu_s();
    tracks += static_cast<double>(tracker.step(s.images[i]).size());
    tracker_s += cpu_s() - middle;
    opencv_s += middle - start;
  }
  const auto n = static_cast<double>(state.iterations());
  state.counters["opencv_ms"] = 1e3 * opencv_s / n;
  state.counters["tracker_ms"] = 1e3 * tracker_s / n;
  state.counters["ratio"] = tracker_s / opencv_s;
  state.counters["tracks"] = tracks / n;
}
BENCHMARK(BM_TrackerOverOpenCv)->Unit(benchmark::kMillisecond)->MinTime(2.0);

}  // namespace
}  // namespace coslam
