// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/map_server.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "common/geometry/alignment.h"
#include "tests/support/sim_map.h"
#include "tests/support/sim_run.h"

namespace coslam {
namespace {
using namespace test;
TEST(MapServer, Probe) {
  const SimWorld world({});
  SimRun run(world, {});
  for (const auto& p : paths_side_by_side(3)) run.add_agent(p);
  for (int i = 0; i < 10; ++i) {
    run.step(30);
    const PathError e = run.path_error();
    std::printf("%d: ate %.4f path %.2f frames %d/%d scale %.3f points %zu keys %zu\n", i, e.ate, e.path_m, e.frames,
                e.all_frames, e.scale, run.map().points().size(), run.map().key_frames().size());
    std::vector<double> n;
    std::vector<Eigen::Vector3d> pe, pt;
    std::vector<Eigen::Matrix3d> cov;
    int agent_ok = 0;
    for (const auto& [id, p] : run.map().points()) {
      const int w = run.world_point(p);
      if (w < 0 || p.map != run.server().largest_map()) continue;
      pe.push_back(p.position); pt.push_back(world.position(w)); cov.push_back(p.covariance);
    }
    {Similarity3 m = *align_points(pt, pe, AlignmentScale::kFree).target_from_source;
    for (int it = 0; it < 5; ++it) {
      n.clear(); std::vector<Eigen::Vector3d> a, b;
      for (size_t k = 0; k < pe.size(); ++k) { n.push_back(nees(pe[k] - m * pt[k], cov[k])); if (n.back() < 30 && cov[k].trace() < 4e-4) {a.push_back(pt[k]); b.push_back(pe[k]);} }
      m = *align_points(a, b, AlignmentScale::kFree).target_from_source;
    }}
    for (int c = 0; c < 3; ++c) agent_ok += run.agent(CameraId(c)).pose_state() == PoseState::kTracked;
    std::printf("   nees median %.2f of %zu, agents tracked %d\n", median(n), n.size(), agent_ok);
  }
  for (const auto& [k, v] : run.server().counts().events) std::printf("%s %ld\n", k.c_str(), v);
  for (const auto& [k, v] : run.server().times().stages()) std::printf("%s mean %.2f\n", k.c_str(), v.mean_ms());
  run.server().finish();
  const PathError e = run.path_error();
  std::printf("end: ate %.4f path %.2f frames %d/%d\n", e.ate, e.path_m, e.frames, e.all_frames);
}
}  // namespace
}  // namespace coslam
