// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// First patches: where that of a track is found in the newest image, under an affine warp.

static int fixed(float value) { return (int)rint(value * 65536.0f); }

static int sample_warped(Level l, int x, int y) {
  const int px = x >> 16, py = y >> 16;
  const int a = (x >> 8) & 255, b = (y >> 8) & 255;
  const int p00 = pixel(l, px, py), p10 = pixel(l, px, py + 1);
  const int upper = (p00 << 8) + (pixel(l, px + 1, py) - p00) * a;
  const int lower = (p10 << 8) + (pixel(l, px + 1, py + 1) - p10) * a;
  return (((upper << 8) + (lower - upper) * b) >> 11) - SAMPLE_CENTRE;
}

static bool warped_readable(Level l, float2 centre, float4 warp) {
  const float2 reach = WINDOW_HALF * FLOAT2(fabs(warp.x) + fabs(warp.y), fabs(warp.z) + fabs(warp.w));
  const float margin = MARGIN - 2;
  return centre.x - reach.x >= -margin && centre.y - reach.y >= -margin &&
         centre.x + reach.x <= (float)(l.cols - 1) + margin && centre.y + reach.y <= (float)(l.rows - 1) + margin;
}

// The sums of a patch, as now seen, with the patch that was seen first: products with the derivatives by all seven
// parameters, mean taken out; and the zncc.
static float project(Level l, float2 centre, float4 warp, __global const Key* key, __local int* room, float* with) {
  const float2 first = centre - WINDOW_HALF * FLOAT2(warp.x + warp.y, warp.z + warp.w);
  const int x0 = fixed(first.x), y0 = fixed(first.y);
  const int x_u = fixed(warp.x), x_v = fixed(warp.y), y_u = fixed(warp.z), y_v = fixed(warp.w);
  int sums[MOST_SUMS] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  for (int k = 0; k < PER_ITEM; ++k) {
    const int c = column_of(k), r = row_of(k), i = r * WINDOW_SIDE + c;
    const int s = sample_warped(l, x0 + c * x_u + r * x_v, y0 + c * y_u + r * y_v);
    const int by_column = (s * (2 * c - (WINDOW_SIDE - 1)) + 8) >> 4;
    const int by_row = (s * (2 * r - (WINDOW_SIDE - 1)) + 8) >> 4;
    const int dx = key->dx[i], dy = key->dy[i], small = s >> TEMPLATE_SHIFT;
    sums[0] += s * dx;
    sums[1] += s * dy;
    sums[2] += by_column * dx;
    sums[3] += by_row * dx;
    sums[4] += by_column * dy;
    sums[5] += by_row * dy;
    sums[6] += s * key->grey[i];
    sums[7] += s;
    sums[8] += small;
    sums[9] += small * small;
  }
  sum_over_group(sums, 10, room);
  const float mean = (float)sums[7] / WINDOW_AREA;
  for (int k = 0; k < 7; ++k) {
    const float moment = k >= 2 && k < 6 ? 8.0f : 1.0f;  // columns and rows count in eighths
    with[k] = moment * (float)sums[k] - key->totals[k] * mean;
  }
  const float squares = centred(sums[9], sums[8], sums[8]);
  return squares > 0 ? with[6] / ((1 << TEMPLATE_SHIFT) * sqrt(squares) * sqrt(key->squares)) : 0;
}

// Gauss-Newton's step: moves at and warp. False when it leads nowhere.
static bool key_step(__global const Key* key, const float* with, float2* at, float4* warp, float* step2) {
  float solution[7];
  for (int r = 0; r < 7; ++r) {
    solution[r] = 0;
    for (int c = 0; c < 7; ++c) solution[r] += key->inverse[7 * r + c] * with[c];
  }
  if (!(solution[6] * TEMPLATE_UNIT > KEY_LEAST_GAIN * SAMPLE_UNIT)) return false;
  for (int r = 0; r < 6; ++r) solution[r] /= solution[6];
  const float a = 1 + solution[2], b = solution[3], c = solution[4], d = 1 + solution[5];
  const float determinant = a * d - b * c;
  if (!(determinant > LEAST_DETERMINANT)) return false;
  const float4 w = *warp;
  *warp = FLOAT4(w.x * d - w.y * c, w.y * a - w.x * b, w.z * d - w.w * c, w.w * a - w.z * b) / determinant;
  const float2 step =
      FLOAT2(warp->x * solution[0] + warp->y * solution[1], warp->z * solution[0] + warp->w * solution[1]);
  *at -= step;
  *step2 = dot(step, step);
  return true;
}

// A group per track: where the first patch of those that were found is.
__kernel void find_keys(__global const uchar* newest, __constant const Size* sizes, int levels,
                        __global const Sought* tracks, __global const Key* keys, __global Sighting* sightings) {
  GROUP_MEMORY int room[MOST_SUMS * GROUP];
  __global const Sought* t = tracks + get_group_id(0);
  __global const Key* key = keys + t->key;
  __global Sighting* s = sightings + 1 + get_group_id(0);
  if (!s->found) return;
  float4 warp = FLOAT4(t->warp[0], t->warp[1], t->warp[2], t->warp[3]);
  int l = 0;
  float scale = 1;
  while (warp.x * warp.w - warp.y * warp.z > WIDEST_SCALE * WIDEST_SCALE * scale * scale && l + 1 < levels) {
    ++l;
    scale *= 2;
  }
  const Level level = level_of(newest, sizes, l);
  const float2 start = FLOAT2(s->x, s->y) / scale;
  float2 at = start;
  warp /= scale;
  float zncc = 0;
  bool good = true, done = false;
  for (int i = 0; i < KEY_ITERATIONS && good && !done; ++i) {
    good = warped_readable(level, at, warp);
    if (good) {
      float with[7], step2 = 0;
      zncc = project(level, at, warp, key, room, with);
      good = key_step(key, with, &at, &warp, &step2);
      const float2 moved = at - start;
      good = good && dot(moved, moved) < KEY_FURTHEST_PX * KEY_FURTHEST_PX;
      done = step2 < KEY_CONVERGED_PX * KEY_CONVERGED_PX;
    }
  }
  if (get_local_id(0) != 0) return;
  s->key_found = good;
  s->key_x = at.x * scale;
  s->key_y = at.y * scale;
  s->key_zncc = zncc;
  warp *= scale;
  s->key_warp[0] = warp.x;
  s->key_warp[1] = warp.y;
  s->key_warp[2] = warp.z;
  s->key_warp[3] = warp.w;
}
