// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Tracks from the image before to the newest and back: from the best of three guesses, and again from where neighbours
// went.

typedef struct {
  __global const uchar *before, *newest;
  __constant const Size* sizes;
  int levels;
} Images;

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
__kernel void match_tracks(__global const uchar* before, __global const uchar* newest, __constant const Size* sizes,
                           int levels, Limits limits, float2 last_shift, __global const Sought* tracks,
                           __global Sighting* sightings) {
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

// The median motion of the nearest tracks that were found at once. False when there are none. Each round takes the
// nearest that is further than the last one taken; of equals the earlier first.
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
__kernel void match_again(__global const uchar* before, __global const uchar* newest, __constant const Size* sizes,
                          int levels, Limits limits, __global const Sought* tracks, int count,
                          __global Sighting* sightings) {
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
