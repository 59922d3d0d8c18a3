// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/wire/coded_tracks.h"

// Predicts where the tracks of an earlier frame are now; both ends of the link compute it alike, bit for bit. For the
// codec only.
namespace coslam {

struct Step {
  Units from, to;
};

// The motion that tracks have in common between two frames: shift, affine part, and the two terms of second order that
// a camera's rotation and a plane cause. With u, v the coordinates from the centre:
//   dx = p0 + (p1 u + p2 v) / 2^16 + u (p6 u + p7 v) / 2^29,  dy = p3 + (p4 u + p5 v) / 2^16 + v (p6 u + p7 v) / 2^29
// The centre is the mean of the tracks, which the reader knows too.
using MotionParameters = std::array<std::int16_t, 8>;

class CommonMotion {
 public:
  CommonMotion(Units centre, const MotionParameters& parameters) : centre_(centre), p_(parameters) {}
  Units shift_at(Units at) const;

 private:
  Units centre_;
  MotionParameters p_;
};

Units centre_of(const std::vector<Units>& tracks);
// The parameters under which most tracks are predicted well, however far the others moved.
MotionParameters fit_motion(Units centre, const std::vector<Step>& steps);

// Predicts the tracks of one frame one after the other: the common motion, and of what the tracks before deviated from
// it the part that the nearest ones suggest.
class TrackPredictor {
 public:
  TrackPredictor(const CommonMotion& motion, std::size_t count);

  Units predict(Units from);
  // Reports the position of the track that was predicted last.
  void observe(Units to);

 private:
  struct Deviation {
    Units from, offset;
  };

  Units deviation_near(Units at) const;

  const CommonMotion motion_;
  std::vector<Deviation> seen_;
  Units moved_;  // the track predicted last, moved by the common motion alone
  Units from_;
};

}  // namespace coslam
