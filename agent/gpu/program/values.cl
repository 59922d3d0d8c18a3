// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The tracker's work on pixels in OpenCL C 1.2, and in CUDA C++ with cuda_dialect.cuh in front: what
// agent/track/{pyramid,motion,align,window,key_patch,corner_score,cell_corners,cpu_matcher}.cpp do, in the same order.
// Sums are of integers, hence the same; what follows them is float here, where the CPU has double: mobile GPUs have
// none. match_program.cpp puts the constants in front, which are those of the CPU; CMakeLists.txt lists the files of
// the program in their order.
//
// This file: what the two languages write apart, the values that kernels take and give, and the pixels of a level.

// What the two languages write apart: a group's own memory, and vectors of so many.
#ifndef __CUDACC__
#pragma OPENCL FP_CONTRACT OFF
#define GROUP_MEMORY __local
#define FLOAT2(x, y) ((float2)(x, y))
#define FLOAT3(x, y, z) ((float3)(x, y, z))
#define FLOAT4(x, y, z, w) ((float4)(x, y, z, w))
#define INT3(x, y, z) ((int3)(x, y, z))
#endif

// Level l of a pyramid: its first pixel in the buffer of all levels, its size, and from one row to the next.
typedef struct {
  int offset, cols, rows, stride;
} Size;

// Values that kernels take and give, as in device_values.h.
typedef struct {
  float from_x, from_y, motion_x, motion_y;
  float warp[4];    // of the first patch, by rows
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
