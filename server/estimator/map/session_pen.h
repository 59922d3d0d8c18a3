// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "server/estimator/map/import_pen.h"

namespace coslam {

// Verbs on a map's session: which agents take part, what they send, what time it is.
class SessionPen : public ImportPen {
 protected:
  using ImportPen::ImportPen;

  CameraId add_camera(const std::string& name, RunId run, const CameraModel& model);
  // Resets a camera whose agent restarted: its old tracks are removed, its poses stay.
  void restart_camera(CameraId id, RunId run, const CameraModel& model);
  void set_alive(CameraId id, bool alive) { mutable_camera(id).alive = alive; }
  // Takes the tracks of a frame set: extends, starts and ends tracks. Poses are left invalid.
  void ingest(const FrameSet& set);

  // Counts frame sets in which nothing was seen.
  void pass_sets(std::uint32_t sets) { map_.now_.value += sets; }
  // Adds by_ns to all known times.
  void shift_times(TimeNs by_ns);

 private:
  void take_tracks(MapCamera& c, const CameraFrame& cf, SetId set);
};

}  // namespace coslam
