// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Arithmetic on sums and scores: means taken out, correlation, the place of a maximum between samples.

// A sum of products with the means of `area` samples taken out.
static float centred_over(int area, int products, int total_a, int total_b) {
  return (float)((long)products * area - (long)total_a * total_b) / area;
}
static float centred(int products, int total_a, int total_b) {
  return centred_over(WINDOW_AREA, products, total_a, total_b);
}

static float zncc_of(int area, int a, int b, int aa, int bb, int ab) {
  const float va = centred_over(area, aa, a, a), vb = centred_over(area, bb, b, b);
  return va > 0 && vb > 0 ? centred_over(area, ab, a, b) / (sqrt(va) * sqrt(vb)) : 0;
}

// How far the top of the parabola through three neighbours is from the middle one.
static float vertex(float before, float at, float after) {
  const float curvature = before - 2 * at + after;
  return curvature < 0 ? clamp(0.5f * (before - after) / curvature, -0.5f, 0.5f) : 0;
}
