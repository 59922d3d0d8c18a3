// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The shift of the whole image: every shift of the coarsest level is tried.

// A group per shift; `zncc` has a rim of zeros around the shifts.
__kernel void try_shifts(__global const uchar* before, __global const uchar* newest, __constant const Size* sizes,
                         int top, __global float* zncc) {
  GROUP_MEMORY int room[5 * GROUP];
  const Level from = level_of(before, sizes, top), to = level_of(newest, sizes, top);
  const int dx = (int)get_group_id(0) - SHIFT_RADIUS - 1, dy = (int)get_group_id(1) - SHIFT_RADIUS - 1;
  const int rx = min(SHIFT_RADIUS, from.cols / 3), ry = min(SHIFT_RADIUS, from.rows / 3);
  const int away_x = max(dx, -dx), away_y = max(dy, -dy);
  const bool tried = away_x <= rx && away_y <= ry;
  const int x0 = max(0, -dx), y0 = max(0, -dy), cols = from.cols - away_x, rows = from.rows - away_y;
  int sums[5] = {0, 0, 0, 0, 0};
  for (int i = get_local_id(0); tried && i < cols * rows; i += GROUP) {
    const int x = x0 + i % cols, y = y0 + i / cols;
    const int p = from.pixels[y * from.stride + x], q = to.pixels[(y + dy) * to.stride + x + dx];
    sums[0] += p;
    sums[1] += q;
    sums[2] += p * p;
    sums[3] += q * q;
    sums[4] += p * q;
  }
  sum_over_group(sums, 5, room);
  if (get_local_id(0) == 0) {
    zncc[get_group_id(1) * SHIFT_SIDE + get_group_id(0)] =
        tried ? zncc_of(cols * rows, sums[0], sums[1], sums[2], sums[3], sums[4]) : 0;
  }
}

// A group. The shift goes where sighting 0 has its place. Of equals the first, by rows, but none before the middle.
__kernel void pick_shift(__global const float* zncc, __constant const Size* sizes, int top,
                         __global Sighting* sightings) {
  GROUP_MEMORY float scores[GROUP];
  GROUP_MEMORY int places[GROUP];
  const int rx = min(SHIFT_RADIUS, sizes[top].cols / 3), ry = min(SHIFT_RADIUS, sizes[top].rows / 3);
  const int centre = SHIFT_RADIUS + 1, cols = 2 * rx + 1, area = cols * (2 * ry + 1);
  __global const float* middle = zncc + centre * SHIFT_SIDE + centre;
  float most = middle[0];
  int best = area;  // the middle; else how many come after
  for (int i = get_local_id(0); i < area; i += GROUP) {
    const float s = middle[(i / cols - ry) * SHIFT_SIDE + i % cols - rx];
    if (s > most) most = s, best = area - 1 - i;
  }
  most_of_group(&most, &best, scores, places);
  if (get_local_id(0) != 0) return;
  const int i = area - 1 - best;
  const int x = best == area ? 0 : i % cols - rx, y = best == area ? 0 : i / cols - ry;
  const float scale = (float)(1 << top);
  middle += y * SHIFT_SIDE + x;
  sightings->x = scale * (x + vertex(middle[-1], middle[0], middle[1]));
  sightings->y = scale * (y + vertex(middle[-SHIFT_SIDE], middle[0], middle[SHIFT_SIDE]));
}
