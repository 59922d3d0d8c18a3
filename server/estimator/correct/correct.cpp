// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/correct/correct.h"

#include <algorithm>
#include <optional>

namespace coslam {

PatchWriter& Correct::writer_of(CameraId camera, const ServerRun& server) {
  return writers_.try_emplace(camera, server, config).first->second;
}

Corrections Correct::run(CorrectEdit& edit, const FrameSet& set, const ServerRun& server,
                         const DescriptorRequestsReport& asked, const ScaleReport& scale, const ViewGraph& graph,
                         Workers& workers) {
  Corrections out;
  const auto is_narrow = [](const CameraFrame& cf) { return cf.frame.narrow_link; };
  std::optional<PatchWorths> worths;
  if (std::ranges::any_of(set.frames, is_narrow)) worths.emplace(edit.map(), set);
  for (const CameraFrame& cf : set.frames) {
    const MapCamera& camera = edit.map().camera(cf.camera);
    const auto asked_camera = asked.requests.find(cf.camera);
    const DescriptorRequest request =
        asked_camera == asked.requests.end() ? DescriptorRequest::kNone : asked_camera->second;
    MapPatch& patch = out.patches.emplace_back(writer_of(cf.camera, server).begin(edit, camera, cf.frame, request));
    patch.scale_known = scale.in_metres.contains(camera.map);
    patch.group = GroupId(static_cast<std::uint32_t>(graph.group_of(cf.camera) + 1));
  }
  const Map& map = edit.map();
  workers.each(out.patches.size(), [&](std::size_t i) {
    const CameraFrame& cf = set.frames[i];
    writers_.at(cf.camera).fill(map, map.camera(cf.camera), cf.frame, is_narrow(cf) ? &*worths : nullptr,
                                &out.patches[i]);
  });
  return out;
}

MapPatch Correct::acknowledge(const Map& map, CameraId camera, const TrackFrame& frame, const ServerRun& server) {
  return writer_of(camera, server).acknowledge(map, map.camera(camera), frame);
}

}  // namespace coslam
