// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/descriptor_requests.h"

#include <set>

namespace coslam {
namespace {

// Returns the maps that live cameras are in.
std::set<MapId> living_maps(const Map& map) {
  std::set<MapId> out;
  for (const MapCamera& c : map.cameras()) {
    if (c.alive && !c.frames.empty() && c.map != MapId()) out.insert(c.map);
  }
  return out;
}

}  // namespace

DescriptorRequestsReport DescriptorRequests::run(const Map& map, const FrameSet& set, Last<ViewGraph> last,
                                                 const ExpectedOverlapReport& expected, const PlaceRecognition& places,
                                                 const PlaceRecognitionReport& met) {
  for (const CameraId camera : met.hinted) asking_.hint(camera, map.now());
  for (const auto& [image_set, camera] : met.described) asking_.came(camera, image_set);
  std::set<MapId> maps = living_maps(map);
  if (!maps.empty()) maps.insert(places.remembered_maps().begin(), places.remembered_maps().end());
  WhyAsk why{.apart = maps.size() > 1, .parted = last.of.groups.size() > 1};
  DescriptorRequestsReport report;
  for (const CameraFrame& cf : set.frames) {
    why.waiting = places.waiting(map, cf.camera);
    why.expects = expected.cameras.contains(cf.camera);
    const DescriptorRequest r = asking_.ask(map, map.camera(cf.camera), why);
    if (r != DescriptorRequest::kNone) report.requests[cf.camera] = r;
  }
  return report;
}

}  // namespace coslam
