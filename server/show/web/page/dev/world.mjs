// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A made-up room (z up, metres), three cameras that fly in it and a man who walks through.
import { add, apply, inverse, lookAt, randomOf } from "./motion.mjs";

const BOXES = [  // furniture: centre on the floor, size
  { at: [-2.6, 1.9], size: [1.6, 0.7, 0.75] },
  { at: [2.4, 2.3], size: [1.8, 0.5, 1.9] },
  { at: [2.9, -1.6], size: [0.8, 1.4, 0.45] },
  { at: [-3.4, -1.9], size: [0.6, 1.2, 1.2] },
  { at: [0.2, 0.3], size: [1.3, 0.8, 0.72] },
];
const HALF = [4, 3];
const HEIGHT = 2.6;

function onBox({ at, size }, random) {
  const p = size.map((s) => (random() - 0.5) * s);
  const face = Math.floor(random() * 5);
  if (face < 4) p[face >> 1] = ((face & 1) - 0.5) * size[face >> 1];
  else p[2] = size[2] / 2;
  return [at[0] + p[0], at[1] + p[1], size[2] / 2 + p[2]];
}

function onWall(random) {
  const wall = Math.floor(random() * 4);
  const axis = wall >> 1;
  const p = [(2 * random() - 1) * HALF[0], (2 * random() - 1) * HALF[1], 0.05 + random() * (HEIGHT - 0.1)];
  p[axis] = ((wall & 1) * 2 - 1) * HALF[axis];
  return p;
}

function onPoster(posters, random) {
  const poster = posters[Math.floor(random() * posters.length)];
  const p = [...poster.at];
  p[1 - poster.axis] += (random() - 0.5) * poster.size[0];
  p[2] += (random() - 0.5) * poster.size[1];
  return p;
}

function postersOf(random) {
  return Array.from({ length: 14 }, () => {
    const at = onWall(random);
    const axis = Math.abs(Math.abs(at[0]) - HALF[0]) < 1e-9 ? 0 : 1;
    at[2] = 0.9 + random() * 0.9;
    return { at, axis, size: [0.6 + random() * 0.7, 0.4 + random() * 0.7] };
  });
}

export function pointsOfRoom(count, seed = 7) {
  const random = randomOf(seed);
  const posters = postersOf(random);
  return Array.from({ length: count }, () => {
    const kind = random();
    const noise = () => (random() - 0.5) * 0.012;
    let p;
    if (kind < 0.34) p = onPoster(posters, random);
    else if (kind < 0.5) p = onWall(random);
    else if (kind < 0.62) p = [(2 * random() - 1) * HALF[0], (2 * random() - 1) * HALF[1], 0];
    else p = onBox(BOXES[Math.floor(random() * BOXES.length)], random);
    return [p[0] + noise(), p[1] + noise(), p[2] + noise()];
  });
}

export const LENS = { width: 752, height: 480, fx: 420, fy: 420, cx: 376, cy: 240 };

// room_from_camera
export function cameraAt(index, t_s) {
  const w = 0.16;
  const phase = [0, 0.5, Math.PI + 0.4][index % 3];
  const a = w * t_s + phase;
  const lift = 1.25 + 0.25 * Math.sin(0.7 * t_s + index) + 0.12 * index;
  const from = [2.5 * Math.cos(a), 1.75 * Math.sin(a), lift];
  const ahead = [1.6 * Math.cos(a + 2.2), 1.4 * Math.sin(a + 2.2), 0.75 + 0.2 * Math.sin(0.31 * t_s + index)];
  return lookAt(from, ahead, 0.06 * Math.sin(0.9 * t_s + 2 * index));
}

export function manAt(t_s) {
  const a = -0.32 * t_s;
  const at = [1.5 * Math.cos(a) + 0.4, 1.25 * Math.sin(a) - 0.35, 0];
  const velocity = [0.32 * 1.5 * Math.sin(a), -0.32 * 1.25 * Math.cos(a), 0];
  return { at, velocity, yaw_rad: Math.atan2(velocity[1], velocity[0]), size: [0.55, 0.45, 1.75] };
}

const bodyOfMan = (() => {
  const random = randomOf(99);
  return Array.from({ length: 70 }, () => {
    const a = random() * 2 * Math.PI;
    return [0.24 * Math.cos(a), 0.2 * Math.sin(a), 0.15 + 1.55 * random(), random() * 6];
  });
})();

export function pointsOfMan(t_s) {
  const { at, yaw_rad } = manAt(t_s);
  const [c, s] = [Math.cos(yaw_rad), Math.sin(yaw_rad)];
  return bodyOfMan.map(([x, y, z, phase]) => {
    const swing = z < 0.8 ? 0.18 * Math.sin(5 * t_s + phase) : 0.03 * Math.sin(5 * t_s + phase);
    return add(at, [c * (x + swing) - s * y, s * (x + swing) + c * y, z]);
  });
}

// Pixel of a point, or null where the camera does not see it.
export function pixelOf(camera_from_room, p) {
  const [x, y, z] = apply(camera_from_room, p);
  if (z < 0.2 || z > 5.5) return null;
  const u = LENS.fx * x / z + LENS.cx;
  const v = LENS.fy * y / z + LENS.cy;
  return u < 0 || v < 0 || u >= LENS.width || v >= LENS.height ? null : [u, v, z];
}

// Who was seen since when and how often; stepped with the time.
export class Seen {
  constructor(points) {
    this.points = points;
    this.first_s = new Float64Array(points.length).fill(Infinity);
    this.views = new Uint16Array(points.length);
    this.by = new Uint8Array(points.length);  // bits of the cameras
  }

  step(t_s, cameras) {
    for (const index of cameras) {
      const camera_from_room = inverse(cameraAt(index, t_s));
      // Each camera finds some of what it sees, not all at once.
      for (let i = (Math.floor(t_s * 10) + index) % 3; i < this.points.length; i += 3) {
        if (!pixelOf(camera_from_room, this.points[i])) continue;
        if (this.first_s[i] === Infinity) {
          if ((i * 7919 + Math.floor(t_s * 11)) % 61 > 2) continue;
          this.first_s[i] = t_s;
        }
        this.views[i] += 1;
        this.by[i] |= 1 << index;
      }
    }
  }

  all() {
    const random = randomOf(3);
    for (let i = 0; i < this.points.length; ++i) {
      this.first_s[i] = 0;
      this.views[i] = 2 + Math.floor(60 * random() ** 2);
      this.by[i] = 3;
    }
  }

  sigma_m(i) { return 0.12 / Math.sqrt(this.views[i]) * (0.6 + (i * 40503 % 97) / 97); }
}
