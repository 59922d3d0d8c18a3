// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The map server's step on the frame sets of so many simulated cameras, over a fixed piece of arithmetic: the Cholesky
// factors of a matrix of 200 rows. Bundle adjustment, which runs beside, is left out.
#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>
#include <ctime>
#include <vector>

#include "server/estimator/map_server.h"
#include "tests/support/sim_run.h"

namespace coslam {
namespace {

constexpr int kSets = 90;

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Who joined a run, and what they saw in it.
struct Seen {
  std::vector<Hello> hellos;
  std::vector<FrameSet> sets;

  explicit Seen(int cameras) {
    const test::SimWorld world({});
    test::SimRun run(world, test::known_baseline(0.8));
    for (int c = 0; c < cameras; ++c) {
      const CameraId id = run.add_agent(test::wave_path({.center_m = {0.8 * c, 0, 0}}));
      hellos.push_back(run.agent(id).tracker().hello());
    }
    for (int i = 0; i < kSets; ++i) {
      run.step();
      sets.push_back(run.last_set());
    }
  }
};

// Both in turn, so that whatever else the machine does weighs on both alike: the ratio that counts.
void BM_StepOverKernel(benchmark::State& state) {
  const Seen seen(static_cast<int>(state.range(0)));
  const Eigen::MatrixXd root = Eigen::MatrixXd::Constant(200, 200, 0.5);
  const Eigen::MatrixXd matrix = root * root.transpose() + Eigen::MatrixXd::Identity(200, 200);
  double step_s = 0, kernel_s = 0, points = 0;
  while (state.KeepRunning()) {
    MapServer server(RunId(7), test::known_baseline(0.8));
    for (const Hello& hello : seen.hellos) server.admit(hello);
    for (const FrameSet& set : seen.sets) {
      const double start = cpu_s();
      benchmark::DoNotOptimize(server.step(set).data());
      const double middle = cpu_s();
      benchmark::DoNotOptimize(Eigen::LLT<Eigen::MatrixXd>(matrix).matrixLLT().data());
      kernel_s += cpu_s() - middle;
      step_s += middle - start;
    }
    points = static_cast<double>(server.map().points().size());
  }
  const auto n = static_cast<double>(state.iterations()) * kSets;
  state.counters["step_ms"] = 1e3 * step_s / n;
  state.counters["kernel_ms"] = 1e3 * kernel_s / n;
  state.counters["ratio"] = step_s / kernel_s;
  state.counters["points"] = points;
}
BENCHMARK(BM_StepOverKernel)->Arg(2)->Arg(4)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace coslam
