// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Windows: their samples between pixels, the template that is cut out of one image, and its comparison with another.

#define PER_ITEM (WINDOW_AREA / GROUP)

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
  const int sum =
      pixel(l, x, y) * f.w00 + pixel(l, x + 1, y) * f.w01 + pixel(l, x, y + 1) * f.w10 + pixel(l, x + 1, y + 1) * f.w11;
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
  float2 by_gain;  // how (dx, dy) go with grey, by its squares
  float3 inverse;  // of the structure tensor, gain and offset eliminated: xx, xy, yy
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
  const float2 with =
      FLOAT2(centred(sums[1], sums[0], t->total_dx), centred(sums[2], sums[0], t->total_dy)) - t->by_gain * with_grey;
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
