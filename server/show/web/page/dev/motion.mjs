// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Rigid transforms as plain rows: {r: 9 numbers by rows, t: 3 numbers}, b_from_a.
export const compose = (a, b) => ({ r: multiply(a.r, b.r), t: add(rotate(a.r, b.t), a.t) });
export const inverse = (a) => {
  const r = transpose(a.r);
  return { r, t: rotate(r, a.t).map((x) => -x) };
};
export const apply = (a, p) => add(rotate(a.r, p), a.t);
export const rotate = (r, p) => [0, 3, 6].map((i) => r[i] * p[0] + r[i + 1] * p[1] + r[i + 2] * p[2]);
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const unit = (a) => { const n = Math.hypot(...a); return a.map((x) => x / n); };
const transpose = (r) => [r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]];
const multiply = (a, b) => [0, 3, 6].flatMap((i) => [0, 1, 2].map((j) =>
  a[i] * b[j] + a[i + 1] * b[3 + j] + a[i + 2] * b[6 + j]));

// Where a camera stands in a room whose z is up: x right, y down, z forward.
export function lookAt(from, at, roll_rad = 0) {
  const z = unit(subtract(at, from));
  const right = unit(cross(z, [0, 0, 1]));
  const down = cross(z, right);
  const [c, s] = [Math.cos(roll_rad), Math.sin(roll_rad)];
  const x = right.map((value, i) => c * value + s * down[i]);
  const y = down.map((value, i) => c * value - s * right[i]);
  return { r: [x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]], t: from };
}

// x y z w
export function quaternion(r) {
  const w = Math.sqrt(Math.max(0, 1 + r[0] + r[4] + r[8])) / 2;
  const x = Math.sqrt(Math.max(0, 1 + r[0] - r[4] - r[8])) / 2;
  const y = Math.sqrt(Math.max(0, 1 - r[0] + r[4] - r[8])) / 2;
  const z = Math.sqrt(Math.max(0, 1 - r[0] - r[4] + r[8])) / 2;
  const signed = (value, like) => (like < 0 ? -value : value);
  return [signed(x, r[7] - r[5]), signed(y, r[2] - r[6]), signed(z, r[3] - r[1]), w];
}

// Numbers in [0, 1) that are the same every time.
export function randomOf(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let x = Math.imul(state ^ (state >>> 15), 1 | state);
    x = (x + Math.imul(x ^ (x >>> 7), 61 | x)) ^ x;
    return ((x ^ (x >>> 14)) >>> 0) / 4294967296;
  };
}
