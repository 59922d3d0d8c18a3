// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// ros2_listener SOURCE SECONDS WIDTH HEIGHT ENCODING: hears images of cyclone_camera as an agent does and says how many
// came, how many of those in between did not, how many were not what was sent, and what an image costs of the CPU.
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "agent/capture/source.h"
#include "common/base/error.h"
#include "tests/interop/ros2_images.h"

namespace coslam {
namespace {

double seconds_of(const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); }

double process_cpu_s() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return seconds_of(used.ru_utime) + seconds_of(used.ru_stime);
}

double thread_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

int listen(char** argv) {
  const int width = std::atoi(argv[3]), height = std::atoi(argv[4]);
  std::vector<cv::Mat> expected;
  for (int kind = 0; kind < test::kKindsOfImage; ++kind)
    expected.push_back(test::grey_image(kind, width, height, argv[5]));
  SourceOptions options;
  options.duration_s = std::atof(argv[2]);
  const auto source = open_source(argv[1], options);
  long first = -1, last = -1, images = 0, wrong = 0;
  double checks_s = 0;
  const double start_s = process_cpu_s();
  while (const auto image = source->next()) {
    const double check_start_s = thread_cpu_s();
    const long number = test::number_of(image->capture_ns);
    if (number <= last || !test::same(image->grey, expected[static_cast<std::size_t>(number) % expected.size()]))
      ++wrong;
    if (first < 0) first = number;
    last = number;
    ++images;
    checks_s += thread_cpu_s() - check_start_s;
  }
  const double cpu_s = process_cpu_s() - start_s - checks_s;
  std::printf("%s: %ld images, %ld missing between them, %ld wrong, %zu undated, %.2f ms of CPU an image\n", argv[1],
              images, last - first + 1 - images, wrong, source->undated(), 1e3 * cpu_s / static_cast<double>(images));
  return images > 0 && wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace coslam

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "usage: ros2_listener SOURCE SECONDS WIDTH HEIGHT ENCODING\n");
    return 2;
  }
  try {
    return coslam::listen(argv);
  } catch (const coslam::UserError& e) {
    std::fprintf(stderr, "ros2_listener: %s\n", e.what());
    return 1;
  }
}
