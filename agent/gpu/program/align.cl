// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Alignment: a window followed from one image into another, level by level.

static bool align_level(const Template* t, Level l, bool fine, float2* at_px, __local int* room) {
  const float converged = fine ? CONVERGED_FINE_PX : CONVERGED_COARSE_PX;
  const int iterations = fine ? FINE_ITERATIONS : COARSE_ITERATIONS;
  float2 at = *at_px;
  bool done = false, good = window_readable(l, at);
  for (int i = 0; i < iterations && good && !done; ++i) {
    float gain;
    const float2 offset = window_step(l, at, t, room, &gain);
    good = gain > LEAST_GAIN;
    if (good) {
      const float far = length(offset);
      at -= offset * (far > WIDEST_STEP_PX ? WIDEST_STEP_PX / far : 1.0f);
      const float2 moved = at - *at_px;
      good = !(dot(moved, moved) > FURTHEST_PX * FURTHEST_PX) && window_readable(l, at);
      done = far < converged;
    }
  }
  if (good) *at_px = at;
  return good;
}

// Follows the window around from_px from one image into the other. False when it is not found; else px, and zncc where
// `zncc` is not null.
static bool align(__global const uchar* from, __global const uchar* to, __constant const Size* sizes, int top,
                  float2 from_px, float2 guess_px, float2* px, float* zncc, __local int* room) {
  float2 motion = guess_px - from_px;
  bool found = false;
  Template t;
  for (int l = top; l >= 0; --l) {
    const float scale = 1.0f / (1 << l);
    const Level source = level_of(from, sizes, l), target = level_of(to, sizes, l);
    const float2 centre = from_px * scale;
    if (window_readable(source, centre)) {
      cut_template(source, centre, &t, room);
      float2 at = centre + motion * scale;
      if (t.min_eigenvalue >= LEAST_TEXTURE && align_level(&t, target, l == 0, &at, room)) {
        motion = (at - centre) / scale;
        if (l == 0) {
          found = true;
          *px = from_px + motion;
          if (zncc) *zncc = window_zncc(target, at, &t, room);
        }
      }
    }
  }
  return found;
}
