// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The tracker's work on pixels in OpenCL C 1.2, and in CUDA C++ with cuda_dialect.cuh in front: what agent/track/{pyramid,motion,
// align,window,key_patch,corner_score,cell_corners,cpu_matcher}.cpp do, in the same order. Sums are of integers, hence the same;
// what follows them is float here, where the CPU has double: mobile GPUs have none. match_program.cpp puts the constants in
// front, which are those of the CPU.
//
// A work-group of GROUP items, 1 or a power of 4, has one track; every item has PER_ITEM samples of its window and knows all
// sums. Barriers stand only where all items of a group come alike: whatever decides on the way is the same in all.

// What the two languages write apart: a group's own memory, and vectors of so many.
#ifndef __CUDACC__
#pragma OPENCL FP_CONTRACT OFF
#define GROUP_MEMORY __local
#define FLOAT2(x, y) ((float2)(x, y))
#define FLOAT3(x, y, z) ((float3)(x, y, z))
#define FLOAT4(x, y, z, w) ((float4)(x, y, z, w))
#define INT3(x, y, z) ((int3)(x, y, z))
#endif

#define PER_ITEM (WINDOW_AREA / GROUP)
#define MOST_SUMS 10
#if GROUP == 1
#define GROUP_BARRIER()
#else
#define GROUP_BARRIER() barrier(CLK_LOCAL_MEM_FENCE)
#endif

// Level l of a pyramid: its first pixel in the buffer of all levels, its size, and from one row to the next.
typedef struct {
  int offset, cols, rows, stride;
} Size;

// As in device_matcher.cpp.
typedef struct {
  float from_x, from_y, motion_x, motion_y;
  float warp[4];  // of the first patch, by rows
  int moving, key;  // which of the first patches is its own
} Sought;

typedef struct {
  short grey[WINDOW_AREA], dx[WINDOW_AREA], dy[WINDOW_AREA];
  float squares;
  float totals[7];
  float inverse[49];  // symmetric
} Key;

typedef struct {
  int found;  // 1: from image to image, 2: so from a start that neighbours lent
  float x, y;
  int key_found;
  float key_x, key_y, key_zncc;
  float key_warp[4];
} Sighting;

typedef struct {
  float min_zncc, forward_backward_px, border_px;
} Limits;

typedef struct {
  int x0, y0, x1, y1;
} Cell;

typedef struct {
  float x, y, score;
} Corner;

typedef struct {
  float mean_score;
  int count;
  Corner corners[MOST_CELL_CORNERS];  // strongest first
} CellCorners;

typedef struct {
  __global const uchar* pixels;
  int cols, rows, stride;
} Level;

static Level level_of(__global const uchar* pyramid, __constant const Size* sizes, int l) {
  const Level level = {pyramid + sizes[l].offset, sizes[l].cols, sizes[l].rows, sizes[l].stride};
  return level;
}

// The border is repeated.
static int pixel(Level l, int x, int y) {
  return l.pixels[clamp(y, 0, l.rows - 1) * l.stride + clamp(x, 0, l.cols - 1)];
}

// Pyramid.

static int mirrored(int i, int size) { return i < 0 ? -i : i >= size ? 2 * size - 2 - i : i; }

__kernel void halve(__global uchar* pyramid, __constant const Size* sizes, int l) {
  const Level finer = level_of(pyramid, sizes, l - 1);
  const int x = get_global_id(0), y = get_global_id(1), cols = sizes[l].cols;
  if (x >= cols || y >= sizes[l].rows) return;
  const int weights[5] = {1, 4, 6, 4, 1};
  int sum = 0;
  for (int r = 0; r < 5; ++r) {
    const int row = mirrored(2 * y + r - 2, finer.rows) * finer.stride;
    for (int c = 0; c < 5; ++c) {
      sum += weights[r] * weights[c] * finer.pixels[row + mirrored(2 * x + c - 2, finer.cols)];
    }
  }
  pyramid[sizes[l].offset + y * sizes[l].stride + x] = (uchar)((sum + 128) >> 8);
}

// Sums.

// Makes of each item's sums those of the group.
static void sum_over_group(int* sums, int count, __local int* room) {
#if GROUP > 1
  const int item = get_local_id(0);
  for (int k = 0; k < count; ++k) room[k * GROUP + item] = sums[k];
  for (int width = GROUP / 4; width > 1; width /= 4) {
    GROUP_BARRIER();
    if (item < width) {
      for (int k = 0; k < count; ++k) {
        __local int* r = room + k * GROUP + item;
        r[0] += r[width] + r[2 * width] + r[3 * width];
      }
    }
  }
  GROUP_BARRIER();
  for (int k = 0; k < count; ++k) {
    __local const int* r = room + k * GROUP;
    sums[k] = r[0] + r[1] + r[2] + r[3];
  }
  GROUP_BARRIER();
#endif
}

// A sum of products with the means of `area` samples taken out.
static float centred_over(int area, int products, int total_a, int total_b) {
  return (float)((long)products * area - (long)total_a * total_b) / area;
}
static float centred(int products, int total_a, int total_b) {
  return centred_over(WINDOW_AREA, products, total_a, total_b);
}

// The shift of the whole image.

static float zncc_of(int area, int a, int b, int aa, int bb, int ab) {
  const float va = centred_over(area, aa, a, a), vb = centred_over(area, bb, b, b);
  return va > 0 && vb > 0 ? centred_over(area, ab, a, b) / (sqrt(va) * sqrt(vb)) : 0;
}

// A group per shift; `zncc` has a rim of zeros around the shifts.
__kernel void try_shifts(__global const uchar* before, __global const uchar* newest, __constant const Size* sizes, int top,
                       __global float* zncc) {
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

static float vertex(float before, float at, float after) {
  const float curvature = before - 2 * at + after;
  return curvature < 0 ? clamp(0.5f * (before - after) / curvature, -0.5f, 0.5f) : 0;
}

// Which item has the most, and of equals the last; `at` is what each of them is asked about, -1 for nothing.
static void most_of_group(float* score, int* at, __local float* scores, __local int* places) {
#if GROUP > 1
  const int item = get_local_id(0);
  scores[item] = *score;
  places[item] = *at;
  for (int width = GROUP / 2; width > 0; width /= 2) {
    GROUP_BARRIER();
    if (item < width) {
      const float s = scores[item + width];
      const int place = places[item + width];
      const bool more = s > scores[item] || (s == scores[item] && place > places[item]);
      if (place >= 0 && (places[item] < 0 || more)) scores[item] = s, places[item] = place;
    }
  }
  GROUP_BARRIER();
  *score = scores[0];
  *at = places[0];
  GROUP_BARRIER();
#endif
}

// A group. The shift goes where sighting 0 has its place. Of equals the first, by rows, but none before the middle.
__kernel void pick_shift(__global const float* zncc, __constant const Size* sizes, int top, __global Sighting* sightings) {
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

// Windows.

// Whole pixel and bilinear weights of the first sample; the others of a window share its fractions.
typedef struct {
  int x, y, w00, w01, w10, w11;
} First;

static int weight(float w) { return (int)(w * WEIGHT_SUM + 0.5f); }

static First first_sample(float2 at) {
  First f;
  f.x = (int)(at.x + MARGIN) - MARGIN;
  f.y = (int)(at.y + MARGIN) - MARGIN;
  const float a = at.x - f.x, b = at.y - f.y;
  f.w01 = weight(a * (1 - b));
  f.w10 = weight((1 - a) * b);
  f.w11 = min(weight(a * b), WEIGHT_SUM - f.w01 - f.w10);
  f.w00 = WEIGHT_SUM - f.w01 - f.w10 - f.w11;
  return f;
}

static int sample(Level l, First f, int c, int r) {
  const int x = f.x + c, y = f.y + r;
  const int sum = pixel(l, x, y) * f.w00 + pixel(l, x + 1, y) * f.w01 + pixel(l, x, y + 1) * f.w10 +
                  pixel(l, x + 1, y + 1) * f.w11;
  return (sum >> WEIGHT_SHIFT) - SAMPLE_CENTRE;
}

static bool window_readable(Level l, float2 centre) {
  return centre.x >= -WINDOW_REACH && centre.y >= -WINDOW_REACH && centre.x <= (float)(l.cols - 1) + WINDOW_REACH &&
         centre.y <= (float)(l.rows - 1) + WINDOW_REACH;
}

typedef struct {
  int grey[PER_ITEM], dx[PER_ITEM], dy[PER_ITEM];  // of this item
  int total_grey, total_dx, total_dy;
  float squares;
  float2 by_gain;   // how (dx, dy) go with grey, by its squares
  float3 inverse;   // of the structure tensor, gain and offset eliminated: xx, xy, yy
  float min_eigenvalue;
} Template;

static int column_of(int k) { return (get_local_id(0) + k * GROUP) % WINDOW_SIDE; }
static int row_of(int k) { return (get_local_id(0) + k * GROUP) / WINDOW_SIDE; }

static void prepare(Template* t, const int* sums) {
  t->total_dx = sums[0];
  t->total_dy = sums[1];
  t->total_grey = sums[2];
  t->squares = centred(sums[5], sums[2], sums[2]);
  t->min_eigenvalue = 0;
  if (!(t->squares > 0)) return;
  const float2 g = FLOAT2(centred(sums[7], sums[0], sums[2]), centred(sums[8], sums[1], sums[2]));
  t->by_gain = g / t->squares;
  const float xx = centred(sums[3], sums[0], sums[0]) - g.x * t->by_gain.x;
  const float xy = centred(sums[6], sums[0], sums[1]) - g.x * t->by_gain.y;
  const float yy = centred(sums[4], sums[1], sums[1]) - g.y * t->by_gain.y;
  const float spread = sqrt(0.25f * (xx - yy) * (xx - yy) + xy * xy);
  t->min_eigenvalue = (0.5f * (xx + yy) - spread) / (TEMPLATE_UNIT * TEMPLATE_UNIT);
  t->inverse = FLOAT3(yy, -xy, xx) / (xx * yy - xy * xy);
}

static void cut_template(Level l, float2 centre, Template* t, __local int* room) {
  const First first = first_sample(centre - WINDOW_HALF);
  int sums[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  for (int k = 0; k < PER_ITEM; ++k) {
    const int c = column_of(k), r = row_of(k);
    const int grey = sample(l, first, c, r) >> TEMPLATE_SHIFT;
    const int dx = (sample(l, first, c + 1, r) - sample(l, first, c - 1, r)) >> (TEMPLATE_SHIFT + 1);
    const int dy = (sample(l, first, c, r + 1) - sample(l, first, c, r - 1)) >> (TEMPLATE_SHIFT + 1);
    t->grey[k] = grey;
    t->dx[k] = dx;
    t->dy[k] = dy;
    sums[0] += dx;
    sums[1] += dy;
    sums[2] += grey;
    sums[3] += dx * dx;
    sums[4] += dy * dy;
    sums[5] += grey * grey;
    sums[6] += dx * dy;
    sums[7] += dx * grey;
    sums[8] += dy * grey;
  }
  sum_over_group(sums, 9, room);
  prepare(t, sums);
}

// How far `centre` lies from where the template is found, and with which gain.
static float2 window_step(Level l, float2 centre, const Template* t, __local int* room, float* gain) {
  const First first = first_sample(centre - WINDOW_HALF);
  int sums[4] = {0, 0, 0, 0};
  for (int k = 0; k < PER_ITEM; ++k) {
    const int s = sample(l, first, column_of(k), row_of(k));
    sums[0] += s;
    sums[1] += s * t->dx[k];
    sums[2] += s * t->dy[k];
    sums[3] += s * t->grey[k];
  }
  sum_over_group(sums, 4, room);
  const float with_grey = centred(sums[3], sums[0], t->total_grey);
  const float2 with = FLOAT2(centred(sums[1], sums[0], t->total_dx), centred(sums[2], sums[0], t->total_dy)) -
                      t->by_gain * with_grey;
  const float2 moved = FLOAT2(t->inverse.x * with.x + t->inverse.y * with.y,
                                t->inverse.y * with.x + t->inverse.z * with.y);  // gain * offset
  const float solved = with_grey / t->squares - dot(t->by_gain, moved);
  *gain = solved * TEMPLATE_UNIT / SAMPLE_UNIT;
  return moved / solved;
}

// The square with the mean taken out of samples whose sums are these, in template units.
static float window_zncc(Level l, float2 centre, const Template* t, __local int* room) {
  const First first = first_sample(centre - WINDOW_HALF);
  int sums[4] = {0, 0, 0, 0};
  for (int k = 0; k < PER_ITEM; ++k) {
    const int s = sample(l, first, column_of(k), row_of(k)), small = s >> TEMPLATE_SHIFT;
    sums[0] += s;
    sums[1] += s * t->grey[k];
    sums[2] += small;
    sums[3] += small * small;
  }
  sum_over_group(sums, 4, room);
  const float squares = centred(sums[3], sums[2], sums[2]);
  if (!(squares > 0) || !(t->squares > 0)) return 0;
  return centred(sums[1], sums[0], t->total_grey) / ((1 << TEMPLATE_SHIFT) * sqrt(squares) * sqrt(t->squares));
}

// Alignment.

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

typedef struct {
  __global const uchar *before, *newest;
  __constant const Size* sizes;
  int levels;
} Images;

// Follows the window around from_px from one image into the other. False when it is not found; else px, and zncc where
// `zncc` is not null.
static bool align(__global const uchar* from, __global const uchar* to, __constant const Size* sizes, int top, float2 from_px,
                  float2 guess_px, float2* px, float* zncc, __local int* room) {
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

// Of three guesses, that whose surroundings look most alike, and the level to start from.
static float2 best_guess(Images images, float2 from_px, const float2* guesses, int* top, __local int* room) {
  const int l = min(GUESS_LEVEL, images.levels - 1);
  const float scale = 1.0f / (1 << l);
  const Level source = level_of(images.before, images.sizes, l), target = level_of(images.newest, images.sizes, l);
  float2 best = guesses[0];
  float best_zncc = -2;
  *top = images.levels - 1;
  if (!window_readable(source, from_px * scale)) return best;
  Template t;
  cut_template(source, from_px * scale, &t, room);
  for (int i = 0; i < 3; ++i) {
    const float2 at = guesses[i] * scale;
    if (window_readable(target, at)) {
      const float zncc = window_zncc(target, at, &t, room);
      if (zncc > best_zncc) best_zncc = zncc, best = guesses[i];
    }
  }
  if (best_zncc > ALIKE_ZNCC) *top = max(0, l - 1);
  return best;
}

static bool inside(__constant const Size* image, float2 px, float border) {
  return px.x >= border && px.y >= border && px.x <= (float)(image->cols - 1) - border &&
         px.y <= (float)(image->rows - 1) - border;
}

// From the image before to the newest, from level `top` down, and back.
static bool match(Images images, const Limits* limits, float2 from_px, bool moving, float2 guess_px, int top,
                  float2* px, __local int* room) {
  float zncc;
  if (!align(images.before, images.newest, images.sizes, top, from_px, guess_px, px, &zncc, room)) return false;
  if (!inside(images.sizes, *px, limits->border_px)) return false;
  if (zncc < (moving ? MOVING_ZNCC : 1.0f) * limits->min_zncc) return false;
  float2 back;
  if (!align(images.newest, images.before, images.sizes, min(BACKWARD_TOP, images.levels - 1), *px, from_px, &back, 0,
             room))
    return false;
  return length(back - from_px) <= (moving ? MOVING_FORWARD_BACKWARD : 1.0f) * limits->forward_backward_px;
}

static float2 from_of(__global const Sought* t) { return FLOAT2(t->from_x, t->from_y); }

// A group per track. Sighting 0 is the shift of the image.
__kernel void match_tracks(__global const uchar* before, __global const uchar* newest, __constant const Size* sizes, int levels,
                         Limits limits, float2 last_shift, __global const Sought* tracks, __global Sighting* sightings) {
  GROUP_MEMORY int room[MOST_SUMS * GROUP];
  const Images images = {before, newest, sizes, levels};
  __global const Sought* t = tracks + get_group_id(0);
  const float2 shift = FLOAT2(sightings->x, sightings->y);
  const float2 from = from_of(t), motion = FLOAT2(t->motion_x, t->motion_y);
  const float2 guesses[3] = {from + motion, from + motion + (shift - last_shift), from + shift};
  int top;
  const float2 guess = best_guess(images, from, guesses, &top, room);
  float2 px = from;
  const bool found = match(images, &limits, from, t->moving, guess, top, &px, room);
  if (get_local_id(0) == 0) {
    __global Sighting* s = sightings + 1 + get_group_id(0);
    s->found = found;
    s->x = px.x;
    s->y = px.y;
  }
}

static float median(const float* values, int count) {
  float sorted[MOTION_NEIGHBOURS];
  for (int i = 0; i < count; ++i) {
    int k = i;
    for (; k > 0 && sorted[k - 1] > values[i]; --k) sorted[k] = sorted[k - 1];
    sorted[k] = values[i];
  }
  return sorted[count / 2];
}

// The median motion of the nearest tracks that were found at once. False when there are none. Each round takes the nearest
// that is further than the last one taken; of equals the earlier first.
static bool motion_near(float2 px, int count, __global const Sought* tracks, __global const Sighting* sightings,
                        float2* motion, __local float* room_distances, __local int* room_places) {
  float x[MOTION_NEIGHBOURS], y[MOTION_NEIGHBOURS];
  float last_distance = -1;
  int last = -1, known = 0;
  for (bool more = true; more && known < MOTION_NEIGHBOURS;) {
    float least = INFINITY;
    int nearest = -1;
    for (int i = get_local_id(0); i < count; i += GROUP) {
      if (sightings[1 + i].found != 1) continue;
      const float2 away = from_of(tracks + i) - px;
      const float distance = dot(away, away);
      const bool next = distance > last_distance || (distance == last_distance && i > last);
      if (next && distance < least) least = distance, nearest = i;
    }
    float nearness = -least;
    int place = nearest >= 0 ? count - 1 - nearest : -1;  // of equals the last is the first track
    most_of_group(&nearness, &place, room_distances, room_places);
    more = place >= 0;
    if (more) {
      last_distance = -nearness;
      last = count - 1 - place;
      const float2 from = from_of(tracks + last);
      x[known] = sightings[1 + last].x - from.x;
      y[known] = sightings[1 + last].y - from.y;
      ++known;
    }
  }
  if (known > 0) *motion = FLOAT2(median(x, known), median(y, known));
  return known > 0;
}

// A group per track: those that were not found, from where their neighbours went.
__kernel void match_again(__global const uchar* before, __global const uchar* newest, __constant const Size* sizes, int levels,
                        Limits limits, __global const Sought* tracks, int count, __global Sighting* sightings) {
  GROUP_MEMORY int room[MOST_SUMS * GROUP];
  GROUP_MEMORY float room_distances[GROUP];
  GROUP_MEMORY int room_places[GROUP];
  const Images images = {before, newest, sizes, levels};
  __global const Sought* t = tracks + get_group_id(0);
  __global Sighting* s = sightings + 1 + get_group_id(0);
  if (s->found) return;
  const float2 from = from_of(t);
  float2 motion, px;
  if (!motion_near(from, count, tracks, sightings, &motion, room_distances, room_places)) return;
  if (!match(images, &limits, from, t->moving, from + motion, min(RETRY_TOP, levels - 1), &px, room)) return;
  if (get_local_id(0) == 0) {
    s->x = px.x;
    s->y = px.y;
    s->found = 2;
  }
}

// First patches.

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
  const float2 step = FLOAT2(warp->x * solution[0] + warp->y * solution[1], warp->z * solution[0] + warp->w * solution[1]);
  *at -= step;
  *step2 = dot(step, step);
  return true;
}

// A group per track: where the first patch of those that were found is.
__kernel void find_keys(__global const uchar* newest, __constant const Size* sizes, int levels, __global const Sought* tracks,
                      __global const Key* keys, __global Sighting* sightings) {
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

// Corners. Column sums and scores are of whole levels, the columns with a rim of CORNER_HALF on either side.

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
__kernel void find_corners(__global const float* scores, __global const float* maxima, __constant const Size* sizes, int l,
                           __global const Cell* cells, __global CellCorners* found) {
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
