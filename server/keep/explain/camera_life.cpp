// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "server/keep/explain/life.h"
#include "server/keep/explain/sentence.h"

namespace coslam::explain {
namespace {

constexpr const char* kPlace = "place";
constexpr const char* kPose = "pose";

class CameraLife {
 public:
  CameraLife(const EventLog& log, CameraId camera) : log_(log) {
    const std::vector<At>& events = log.of_camera.at(camera);
    auto of_map = log.of_maps.begin();
    for (std::size_t i = 0; i < events.size(); ++i) {
      for (; of_map != log.of_maps.end() && *of_map < events[i]; ++of_map) take_map(*of_map);
      const bool rescued = i + 1 < events.size() && take_rescue(events[i], events[i + 1]);
      if (rescued) ++i;
      if (!rescued) take(events[i]);
    }
    for (; of_map != log.of_maps.end(); ++of_map) take_map(*of_map);
  }

  std::vector<Entry> entries;

 private:
  Entry& add(At at, std::string text, std::string aspect = {}, std::string now = {}) {
    entries.push_back({.t_ns = log_.events[at].t_ns,
                       .text = std::move(text),
                       .aspect = std::move(aspect),
                       .now = std::move(now),
                       .at = at});
    return entries.back();
  }

  void take_map(At at) {
    const Event& e = log_.events[at];
    if (map_ == MapId() || e.kind == EventKind::kMapStarted || (e.map != map_ && e.from != map_)) return;
    const bool changes = map_ != e.map;
    map_ = e.map;
    Entry& entry = add(at, map_sentence(e));
    if (e.why == Why::kAdjusted) entry.fold = "adjusted";
    if (!changes) return;
    entry.aspect = kPlace;
    entry.now = "in " + name(map_);
  }

  // Lost and found at one instant: the static points alone gave no pose.
  bool take_rescue(At lost, At found) {
    const Event &l = log_.events[lost], &f = log_.events[found];
    if (l.kind != EventKind::kCameraLost || f.kind != EventKind::kCameraFound || l.set != f.set) return false;
    add(found, "All points of its group, also those that move, gave it the pose that its own did not " + reason(l))
        .fold = "rescued";
    return true;
  }

  void take(At at) {
    const Event& e = log_.events[at];
    switch (e.kind) {
      case EventKind::kCameraJoined:
        map_ = MapId();
        add(at, "It joined " + reason(e), kPlace, "in no map");
        add(at, "", kPose).in_text = false;
        break;
      case EventKind::kCameraPlaced:
        map_ = e.map;
        add(at, "It was put into " + name(map_) + " " + reason(e), kPlace, "in " + name(map_));
        add(at, "", kPose).in_text = false;
        break;
      case EventKind::kCameraLost:
        add(at, "It lost its pose " + reason(e), kPose, "without a pose");
        break;
      case EventKind::kCameraFound:
        add(at, "It had a pose again " + reason(e), kPose);
        break;
      case EventKind::kCameraLeft:
        map_ = MapId();
        add(at, "It left " + name(e.map) + " " + reason(e), kPlace, "in no map");
        break;
      case EventKind::kCameraMisdated:
        add(at, "Its images are dated wrongly, " + reason(e));
        break;
      case EventKind::kCameraLens:
        add(at, "Its lens was corrected " + reason(e));
        break;
      default:
        break;
    }
  }

  const EventLog& log_;
  MapId map_;
};

}  // namespace

std::optional<Life> life_of_camera(const EventLog& log, CameraId camera) {
  if (!log.of_camera.contains(camera)) return std::nullopt;
  CameraLife life(log, camera);
  return Life{.subject = "camera " + name(log, camera), .entries = std::move(life.entries)};
}

}  // namespace coslam::explain
