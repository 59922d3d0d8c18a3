// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/associate/turns.h"

namespace coslam {

std::vector<CameraId> cameras_in_turn(const FrameSet& set, std::uint32_t round) {
  const auto rounds = static_cast<std::uint32_t>((set.frames.size() + kAllLook - 1) / kAllLook);
  std::vector<CameraId> out;
  for (const CameraFrame& cf : set.frames) {
    if ((cf.camera.value + round) % rounds == 0) out.push_back(cf.camera);
  }
  return out;
}

}  // namespace coslam
