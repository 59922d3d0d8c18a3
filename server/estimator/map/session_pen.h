// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "server/estimator/map/import_pen.h"

namespace coslam {

// Verbs on a map's session: who takes part, what comes in, what time it is.
class SessionPen : public ImportPen {
 protected:
  using ImportPen::ImportPen;

  CameraId add_camera(const std::string& name, RunId run, const CameraModel& model);
  // An agent that restarted: its old tracks are gone, its poses stay.
  void restart_camera(CameraId id, RunId run, const CameraModel& model);
  void set_alive(CameraId id, bool alive) { own(id).alive = alive; }
  // Takes the tracks of a frame set: extends, starts and ends tracks. Poses are left invalid.
  void ingest(const FrameSet& set);

  // Nothing was seen for so many frame sets.
  void pass_sets(std::uint32_t sets) { map_.now_.value += sets; }
  // All times that are known are so much later than they were given.
  void shift_times(TimeNs by_ns);

 private:
  void take_tracks(MapCamera& c, const CameraFrame& cf, SetId set);
};

}  // namespace coslam
