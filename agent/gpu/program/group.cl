// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the items of a work-group do together. A work-group of GROUP items, 1 or a power of 4, has one track; every item
// has PER_ITEM samples of its window and knows all sums. Barriers stand only where all items of a group come alike:
// whatever decides on the way is the same in all.

#define MOST_SUMS 10
#if GROUP == 1
#define GROUP_BARRIER()
#else
#define GROUP_BARRIER() barrier(CLK_LOCAL_MEM_FENCE)
#endif

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
