// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/journal.h"
#include "server/estimator/map/map.h"

// The map is written by verbs. They are defined in classes that build on each other (track_pen.h, point_pen.h,
// camera_pen.h, lens_pen.h, maps_pen.h, past_pen.h, session_pen.h), where they are protected: who may call which of
// them is in keys.h.
namespace coslam {

// A map, its journal, and what all verbs are made of. The verbs keep the map's invariants: a track and its point name
// each other, key observations are sorted and unique, the indices behind Map's queries hold. Entities are named by
// references to the map's own, as Map gives them out. Thread-compatible.
class MapPen {
 public:
  const Map& map() const { return map_; }

 protected:
  // Keys are virtual bases of MapEdit, which calls the other constructor; C++ wants this one to exist.
  MapPen() : map_({}) {}
  explicit MapPen(const MapConfig& config) : map_(config) {}
  // Not moved when assigned: keys that were assigned one by one would take it from each other.
  MapPen(const MapPen&) = default;
  MapPen(MapPen&&) = default;
  MapPen& operator=(const MapPen&) = default;
  ~MapPen() = default;

  // Everything given out by Map belongs to it, and is written by the verbs alone.
  MapCamera& own(CameraId id) { return map_.cameras_[id.value]; }
  MapCamera& own(const MapCamera& camera) { return own(camera.id); }
  static ServerTrack& own(const ServerTrack& track) { return const_cast<ServerTrack&>(track); }  // NOLINT: ours
  static MapPoint& own(const MapPoint& point) { return const_cast<MapPoint&>(point); }           // NOLINT: ours
  MapPoint* own(PointId id) { return map_.points_.by_id.find(id); }
  ServerTrack& own(const BoundTrack& b) { return own(b.camera).tracks.at(b.track); }

  Event event(EventKind kind, Why why, Figures figures = {}) const;
  void note_point(EventKind kind, const MapPoint& point, Why why, Figures figures = {});
  void note_track(EventKind kind, CameraId camera, const ServerTrack& track, Why why, Figures figures = {});
  void note_camera(EventKind kind, const MapCamera& camera, Why why, Figures figures = {});

  // The point counts as seen now.
  void touch(MapPoint& point);
  // The point gets a key observation. A track may come back to a point, or its point be fused with one that it was
  // bound to before: each observation is there once.
  void observe(MapPoint& point, const KeyObservation& seen);

  Map map_;
  Journal journal_;
};

}  // namespace coslam
