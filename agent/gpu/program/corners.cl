// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Corners: scores of a level and the strongest maxima of each cell. Column sums and scores are of whole levels, the
// columns with a rim of CORNER_HALF on either side.

static int binomial(int a, int b, int c, int d, int e, int f, int g) {
  return (a + g) + 6 * (b + f) + 15 * (c + e) + 20 * d;
}

// Products of the gradients at (x, y): xx, xy, yy.
static int3 gradients(Level l, int x, int y) {
  const int gx = (pixel(l, x + 1, y - 1) - pixel(l, x - 1, y - 1)) + 2 * (pixel(l, x + 1, y) - pixel(l, x - 1, y)) +
                 (pixel(l, x + 1, y + 1) - pixel(l, x - 1, y + 1));
  const int gy = (pixel(l, x - 1, y + 1) - pixel(l, x - 1, y - 1)) + 2 * (pixel(l, x, y + 1) - pixel(l, x, y - 1)) +
                 (pixel(l, x + 1, y + 1) - pixel(l, x + 1, y - 1));
  return INT3(gx * gx, gx * gy, gy * gy) >> PRODUCT_SHIFT;
}

__kernel void sum_columns(__global const uchar* pyramid, __constant const Size* sizes, int l, __global int* columns) {
  const Level level = level_of(pyramid, sizes, l);
  const int i = get_global_id(0), y = get_global_id(1), width = level.cols + 2 * CORNER_HALF;
  if (i >= width) return;
  const int weights[7] = {1, 6, 15, 20, 15, 6, 1};
  int3 sum = INT3(0, 0, 0);
  for (int r = 0; r < 7; ++r) sum += weights[r] * gradients(level, i - CORNER_HALF, y + r - CORNER_HALF);
  vstore3(sum, y * width + i, columns);
}

static int across(__global const int* columns) {
  return binomial(columns[0], columns[3], columns[6], columns[9], columns[12], columns[15], columns[18]);
}

__kernel void score_corners(__global const int* columns, __constant const Size* sizes, int l, __global float* scores) {
  const int x = get_global_id(0), y = get_global_id(1), cols = sizes[l].cols;
  if (x >= cols) return;
  columns += 3 * (y * (cols + 2 * CORNER_HALF) + x);
  const float a = across(columns), b = across(columns + 1), c = across(columns + 2);
  const float half_difference = 0.5f * (a - c);
  scores[y * cols + x] = SCORE_SCALE * (0.5f * (a + c) - sqrt(half_difference * half_difference + b * b));
}

// Of equal neighbours exactly one is the maximum: strictly above those that come first.
static bool is_maximum(__global const float* at, int stride) {
  __global const float *up = at - stride, *down = at + stride;
  const float s = at[0];
  return s > up[-1] && s > up[0] && s > up[1] && s > at[-1] && s >= at[1] && s >= down[-1] && s >= down[0] &&
         s >= down[1];
}

// The score where it is a corner's, else 0.
__kernel void keep_maxima(__global const float* scores, __constant const Size* sizes, int l, __global float* maxima) {
  const int x = get_global_id(0), y = get_global_id(1), cols = sizes[l].cols;
  if (x >= cols) return;
  const bool inside = x > 0 && y > 0 && x + 1 < cols && y + 1 < sizes[l].rows;
  __global const float* at = scores + y * cols + x;
  maxima[y * cols + x] = inside && *at >= LEAST_CORNER_SCORE && is_maximum(at, cols) ? *at : 0.0f;
}

// A group per cell. Each round takes the strongest that is weaker than the last one taken; of equals the later first.
__kernel void find_corners(__global const float* scores, __global const float* maxima, __constant const Size* sizes,
                           int l, __global const Cell* cells, __global CellCorners* found) {
  GROUP_MEMORY float score_room[GROUP];
  GROUP_MEMORY int index_room[GROUP];
  const int item = get_local_id(0), stride = sizes[l].cols;
  const Cell cell = cells[get_group_id(0)];
  __global CellCorners* out = found + get_group_id(0);
  const int cols = max(0, cell.x1 - cell.x0), area = cols * max(0, cell.y1 - cell.y0);
  const int first = cell.y0 * stride + cell.x0;
  float total = 0;
  for (int i = item; i < area; i += GROUP) total += scores[first + i / cols * stride + i % cols];
  score_room[item] = total;
  GROUP_BARRIER();
  total = 0;
  for (int k = 0; k < GROUP; ++k) total += score_room[k];
  GROUP_BARRIER();
  float last_score = INFINITY;
  int last = area, count = 0;
  for (bool more = true; more && count < MOST_CELL_CORNERS;) {
    float best_score = 0;
    int best = -1;
    for (int i = item; i < area; i += GROUP) {
      const float s = maxima[first + i / cols * stride + i % cols];
      const bool next = s < last_score || (s == last_score && i < last);
      if (next && s > 0 && s >= best_score) best_score = s, best = i;
    }
    most_of_group(&best_score, &best, score_room, index_room);
    more = best >= 0;
    if (more && item == 0) {
      __global const float* at = scores + first + best / cols * stride + best % cols;
      out->corners[count].x = (float)(cell.x0 + best % cols) + vertex(at[-1], best_score, at[1]);
      out->corners[count].y = (float)(cell.y0 + best / cols) + vertex(at[-stride], best_score, at[stride]);
      out->corners[count].score = best_score;
    }
    if (more) ++count;
    last_score = best_score;
    last = best;
  }
  if (item == 0) {
    out->mean_score = area > 0 ? total / area : 0;
    out->count = count;
  }
}
