// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Images a second that one process tracks for so many cameras at once (`streams`) of so many tracks each, on the CPU,
// by OpenCL and by CUDA, each camera a textured plane of its own path, as many threads as the machine has cores. Beside
// them OpenCV's bare Lucas-Kanade with as many points on the CPU, and the bound: how many such images go into the
// device's memory a second.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <functional>
#include <memory>
#include <opencv2/video/tracking.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "agent/track/tracker.h"
#include "tests/support/compared_matcher.h"
#include "tests/support/synthetic_view.h"
#include "tests/support/tracking_devices.h"

namespace coslam {
namespace {

constexpr std::size_t kImages = 60;
constexpr std::size_t kPaths = 8;

// A closed path, which may be gone round without a jump; another for each `path`.
std::vector<cv::Mat> images_along(std::size_t path) {
  const cv::Size size(640, 480);
  const cv::Mat texture = test::plane_texture(1400, 1100, path + 1);
  std::vector<cv::Mat> images;
  for (std::size_t i = 0; i < kImages; ++i) {
    const double a = 2 * CV_PI * (static_cast<double>(i) / kImages + static_cast<double>(path) / kPaths);
    images.push_back(test::render(texture, test::view_on_loop(a, {100, 60}, 0.2, 0.1, size), size, i + 1));
  }
  return images;
}

const std::vector<cv::Mat>& images_of(std::size_t stream) {
  static const std::vector<std::vector<cv::Mat>> all = [] {
    std::vector<std::vector<cv::Mat>> paths;
    for (std::size_t p = 0; p < kPaths; ++p) paths.push_back(images_along(p));
    return paths;
  }();
  return all[stream % kPaths];
}

double process_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Calls work(stream) for each of them, on all cores.
void for_each_stream(std::size_t streams, const std::function<void(std::size_t)>& work) {
  const std::size_t threads = std::min<std::size_t>(streams, std::max(1U, std::thread::hardware_concurrency()));
  std::vector<std::jthread> pool;
  for (std::size_t t = 0; t < threads; ++t) {
    pool.emplace_back([&, t] {
      for (std::size_t s = t; s < streams; s += threads) work(s);
    });
  }
}

// Once round the path in each iteration; each thread goes from camera to camera.
void run_streams(benchmark::State& state, const std::function<void(std::size_t stream, std::size_t image)>& step) {
  const auto streams = static_cast<std::size_t>(state.range(0));
  cv::setNumThreads(1);
  const auto round = [&](std::size_t stream) {
    for (std::size_t i = 0; i < kImages; ++i) step(stream, i);
  };
  for_each_stream(streams, round);  // tracks begin, memory is taken
  const double start_s = process_cpu_s();
  while (state.KeepRunning()) for_each_stream(streams, round);
  const auto images = static_cast<double>(state.iterations()) * static_cast<double>(streams * kImages);
  state.counters["images_per_s"] = benchmark::Counter(images, benchmark::Counter::kIsRate);
  state.counters["cpu_ms_per_image"] = 1e3 * (process_cpu_s() - start_s) / images;
}

TrackerConfig config_of(const benchmark::State& state) {
  TrackerConfig config;
  config.max_tracks = static_cast<int>(state.range(1));
  return config;
}

void track(benchmark::State& state, const std::string& by) {
  const auto streams = static_cast<std::size_t>(state.range(0));
  const TrackerConfig config = config_of(state);
  std::vector<std::unique_ptr<Tracker>> trackers;
  try {
    for (std::size_t s = 0; s < streams; ++s) {
      if (by == "cpu") {
        trackers.push_back(std::make_unique<Tracker>(config));
      } else {
        DeviceMatcher made = test::matcher_by(by, config);
        state.SetLabel(made.device);
        trackers.push_back(std::make_unique<Tracker>(config, std::move(made.matcher)));
      }
    }
  } catch (const DeviceFailure& failure) {
    state.SkipWithError(failure.what());
    return;
  }
  run_streams(state, [&](std::size_t s, std::size_t i) { trackers[s]->step(images_of(s)[i]); });
  state.counters["tracks"] = static_cast<double>(trackers.front()->live().size());
}

void BM_OpenCvLucasKanade(benchmark::State& state) {
  std::vector<cv::Point2f> points;
  for (int i = 0; i < state.range(1); ++i) points.emplace_back(20 + 7 * i % 600, 20 + 11 * i % 440);
  run_streams(state, [&](std::size_t s, std::size_t i) {
    std::vector<cv::Point2f> found;
    std::vector<unsigned char> status;
    std::vector<float> error;
    const std::vector<cv::Mat>& images = images_of(s);
    cv::calcOpticalFlowPyrLK(images[i], images[(i + 1) % kImages], points, found, status, error);
    benchmark::DoNotOptimize(found.data());
  });
}

// An image with its margin, alone, again and again.
void BM_UploadsOnly(benchmark::State& state, const std::string& by) {
  try {
    const auto device = test::device_by(by);
    Pyramid pyramid;
    pyramid.build(images_of(0).front(), 1);
    const PyramidLevel& image = pyramid.level(0);
    const Device::Handle memory = device->memory(image.bytes());
    while (state.KeepRunning()) {
      device->start_write(memory, 0, image.first_byte(), image.bytes());
      device->finish();
    }
    state.counters["images_per_s"] =
        benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
    state.counters["bytes"] = static_cast<double>(image.bytes());
  } catch (const DeviceFailure& failure) {
    state.SkipWithError(failure.what());
  }
}

// Once round a path: how far the device's answers are from the CPU's, in pixels, and how many more than 0.05.
void BM_AgreesWithCpu(benchmark::State& state, const std::string& by) {
  try {
    DeviceMatcher made = test::matcher_by(by, {});
    state.SetLabel(made.device);
    test::Agreement agreement;
    Tracker tracker({}, std::make_unique<test::ComparedMatcher>(cpu_matcher({}), std::move(made.matcher), &agreement));
    while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(kImages))) {
      for (const cv::Mat& image : images_of(0)) tracker.step(image);
    }
    const std::vector<float>& d = agreement.distances_px;
    const auto apart = std::count_if(d.begin(), d.end(), [](float px) { return px > 0.05F; });
    state.counters["tracks"] = static_cast<double>(d.size());
    state.counters["median_px"] = test::quantile(d, 0.5);
    state.counters["p99_px"] = test::quantile(d, 0.99);
    state.counters["apart"] = static_cast<double>(apart) / static_cast<double>(d.size());
    state.counters["corners_p99_px"] = test::quantile(agreement.corner_distances_px, 0.99);
  } catch (const DeviceFailure& failure) {
    state.SkipWithError(failure.what());
  }
}

void of_streams(benchmark::internal::Benchmark* b) {
  b->ArgNames({"streams", "tracks"})->ArgsProduct({{1, 8, 32}, {300, 1000}})->Unit(benchmark::kMillisecond);
  b->UseRealTime();
}
BENCHMARK(BM_OpenCvLucasKanade)->Apply(of_streams);
BENCHMARK_CAPTURE(track, cpu, "cpu")->Apply(of_streams);
BENCHMARK_CAPTURE(track, opencl, "opencl")->Apply(of_streams);
BENCHMARK_CAPTURE(track, cuda, "cuda")->Apply(of_streams);
BENCHMARK_CAPTURE(BM_AgreesWithCpu, opencl, "opencl")->Iterations(1);
BENCHMARK_CAPTURE(BM_AgreesWithCpu, cuda, "cuda")->Iterations(1);
BENCHMARK_CAPTURE(BM_UploadsOnly, opencl, "opencl")->UseRealTime();
BENCHMARK_CAPTURE(BM_UploadsOnly, cuda, "cuda")->UseRealTime();

}  // namespace
}  // namespace coslam
