// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/estimator/map/map_rows.h"
#include "server/estimator/map/past_pen.h"
#include "server/estimator/map/renumber.h"

namespace coslam {

// Verbs that take maps over from files: as this map, or beside it, as if they had been made after it.
class ImportPen : public PastPen {
 protected:
  using PastPen::PastPen;

  // Fills an empty map from rows. Throws UserError when they contradict each other.
  void restore(const Tables& tables, int version = kRowsVersion) { MapRows::restore(tables, version, &map_); }
  // Adds all maps of another one, with their points, frames and paths, beside those of this one; its cameras become new
  // ones, under other names where theirs are taken, and see nothing any more.
  Renumbered take_in(const Map& other);

 private:
  MapCamera as_here(const MapCamera& other, const Renumbered& renumbered) const;
  void take_in_points(const Map& other, const Renumbered& renumbered);
};

}  // namespace coslam
