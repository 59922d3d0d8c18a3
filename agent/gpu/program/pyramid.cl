// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A level of the pyramid from the finer one.

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
