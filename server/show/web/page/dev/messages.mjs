// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The made-up run as the messages that a server sends.
import { CdrWriter } from "./cdr.mjs";
import { add, apply, compose, inverse, lookAt, quaternion, randomOf, rotate } from "./motion.mjs";
import { EVENTS, NAMES, WHY_LOST, frameOf, groupsAt, isLost, mapOf } from "./script.mjs";
import { LENS, Seen, cameraAt, manAt, pixelOf, pointsOfMan, pointsOfRoom } from "./world.mjs";

// map_from_room: a map's axes are those of its first camera; map 2 has a unit of its own.
// Of each camera, once it has moved for a while.
const pathOf = (index, t_s) => t_s < 3 ? null : [
  { quality: "good", why: "", length: 6.12, sigma: 0.0041, sigma_percent: 0.067 },
  { quality: "fair", why: "what it saw leaves its path open by 0.5 % of its length", length: 5.8, sigma: 0.029, sigma_percent: 0.5 },
  { quality: "poor", why: "its images do not tell its path: it hardly moved, or saw too little", length: 0.1, sigma: null, sigma_percent: null },
][index % 3];
const UNIT_2 = 6;
const ROOTS = { 1: inverse(cameraAt(0, 0)), 2: inverse(lookAt([-2.4, 0.3, 1.5], [1.5, -1, 0.9], 0.1)) };

const NOTHING = { moving_points: 0, objects: 0, maps: 0, key_frames: 0 };
const FIELDS = [["x", 7, 4], ["y", 7, 4], ["z", 7, 4], ["sigma", 7, 4], ["id", 6, 4], ["map", 6, 4], ["state", 2, 1], ["views", 4, 2]];
const MOVING_FIELDS = [...FIELDS.slice(0, 5), ["object", 6, 4]];

function cloud(t_s, frame, fields, count, fill, extra = 0) {
  const step = fields.reduce((sum, field) => sum + field[2], extra);
  const data = new Uint8Array(step * count);
  fill(new DataView(data.buffer), step);
  const out = new CdrWriter(data.length + 600).header(t_s, frame).u32(1).u32(count);
  let offset = 0;
  out.sequence(fields, ([name, type, size]) => {
    out.string(name).u32(offset).u8(type).u32(1);
    offset += size;
  });
  return out.u8(0).u32(step).u32(data.length).octets(data).u8(1).done();
}

// x ahead, y left, z up of a camera, whose axes are x right, y down, z ahead.
function ofBase(r) { return [0, 3, 6].flatMap((row) => [r[row + 2], -r[row], -r[row + 1]]); }

function xyzTo(view, at, [x, y, z], sigma) {
  [x, y, z, sigma].forEach((value, i) => view.setFloat32(at + 4 * i, value, true));
}

export class Run {
  constructor({ points = 6000, whole = false, cameras = [0, 1, 2], run = "9f3a61c2" } = {}) {
    this.seen = new Seen(pointsOfRoom(points));
    if (whole) this.seen.all();
    this.whole = whole;
    this.cameras = cameras;
    this.poses = cameras.map(() => []);
    this.random = randomOf(11);
    this.id = run;
    this.lost = new Set();  // besides those of the script
    this.finishing = false;
    this.scaleKnown = true;
  }

  isLost(index, t_s) { return this.lost.has(NAMES[index]) || isLost(NAMES[index], t_s); }

  step(t_s) {
    if (!this.whole) this.seen.step(t_s, this.cameras.filter((i) => !this.isLost(i, t_s)));
    for (const i of this.cameras) {
      if (this.isLost(i, t_s)) continue;
      const poses = this.poses[i];
      if (poses.length && t_s - poses.at(-1).t_s < 0.2) continue;
      poses.push({ t_s, pose: cameraAt(i, t_s) });
    }
  }

  inMap(index, t_s, room_from_camera) {
    const pose = compose(ROOTS[mapOf(index, t_s)], room_from_camera);
    return mapOf(index, t_s) === 2 ? { ...pose, t: pose.t.map((value) => UNIT_2 * value) } : pose;
  }

  // Whole, they stay what they are, and are written once: the mock must not take the time that is measured.
  points(t_s) {
    if (!this.whole) return this.cloudOfPoints(t_s);
    return (this.written ??= this.cloudOfPoints(t_s));
  }

  cloudOfPoints(t_s) {
    const { seen } = this;
    const shown = [];
    for (let i = 0; i < seen.points.length; ++i) if (seen.views[i] > 0) shown.push(i);
    return cloud(t_s, "map", FIELDS, shown.length, (view, step) => shown.forEach((i, row) => {
      const map = seen.by[i] === 4 ? mapOf(2, t_s) : 1;
      const at = row * step;
      const unit = map === 2 ? UNIT_2 : 1;
      xyzTo(view, at, apply(ROOTS[map], seen.points[i]).map((value) => unit * value), unit * seen.sigma_m(i));
      view.setUint32(at + 16, i + 1, true);
      view.setUint32(at + 20, map, true);
      view.setUint8(at + 24, t_s - seen.first_s[i] < 1.5 || seen.views[i] < 6 ? 1 : 0);
      view.setUint16(at + 25, seen.views[i], true);
    }), this.whole ? 1 : 0);
  }

  moving(t_s) {
    const points = pointsOfMan(t_s);
    return cloud(t_s, "map", MOVING_FIELDS, points.length, (view, step) => points.forEach((p, i) => {
      xyzTo(view, i * step, apply(ROOTS[1], p), 0.03);
      view.setUint32(i * step + 16, 900000 + i, true);
      view.setUint32(i * step + 20, 7, true);
    }));
  }

  objects(t_s) {
    const { at, velocity, yaw_rad, size } = manAt(t_s);
    const [c, s] = [Math.cos(yaw_rad), Math.sin(yaw_rad)];
    const box = compose(ROOTS[1], { r: [c, -s, 0, s, c, 0, 0, 0, 1], t: add(at, [0, 0, size[2] / 2]) });
    const tip = add(box.t, rotate(ROOTS[1].r, velocity));
    const out = new CdrWriter(2048);
    const marker = (type, pose, scale, points) => out.header(t_s, "map").string(type ? "boxes" : "velocities").i32(7)
      .i32(type).i32(0).pose(...pose).f64s(scale).f32(1).f32(0.6).f32(0.2).f32(0.8).i32(0).u32(0).u8(0)
      .sequence(points, (p) => out.f64s(p)).u32(0).string("")
      .header(0, "").string("").u32(0).u32(0).string("").string("").string("").u32(0).u8(0);
    return out.sequence([1, 0], (type) => (type === 1
      ? marker(1, [box.t, quaternion(box.r)], size, [])
      : marker(0, [[0, 0, 0], [0, 0, 0, 1]], [0.04, 0.1, 0.1], [box.t, tip]))).done();
  }

  pose(index, t_s) {
    const pose = this.inMap(index, t_s, cameraAt(index, t_s));
    const out = new CdrWriter(900).header(t_s, frameOf(mapOf(index, t_s)));
    const variance = [0.0004, 0.0002, 0.0011, 1e-5, 1e-5, 1e-5];
    const covariance = Array.from({ length: 36 }, (_, i) => (i % 7 === 0 ? variance[i / 7] : i === 2 || i === 12 ? 0.0003 : 0));
    return out.pose(pose.t, quaternion(ofBase(pose.r))).f64s(covariance).done();
  }

  path(index, t_s) {
    const out = new CdrWriter(40000).header(t_s, frameOf(mapOf(index, t_s)));
    const poses = this.poses[index].slice(-500);
    return out.sequence(poses, ({ t_s: at_s, pose }) => {
      const inMap = this.inMap(index, t_s, pose);
      out.header(at_s, frameOf(mapOf(index, t_s))).pose(inMap.t, quaternion(ofBase(inMap.r)));
    }).done();
  }

  keyFrames(index, t_s) {
    const out = new CdrWriter(40000).header(t_s, frameOf(mapOf(index, t_s)));
    return out.sequence(this.poses[index].slice(-500).filter((_, i) => i % 10 === 0), ({ pose }) => {
      const inMap = this.inMap(index, t_s, pose);
      out.pose(inMap.t, quaternion(ofBase(inMap.r)));
    }).done();
  }

  tracks(index, t_s) {
    const camera_from_room = inverse(cameraAt(index, t_s));
    const tracks = [];
    const add = (id, p, state) => {
      const pixel = pixelOf(camera_from_room, p);
      if (pixel) tracks.push([id, Math.round(pixel[0] * 10) / 10, Math.round(pixel[1] * 10) / 10, state]);
    };
    const { points } = this.seen;
    const stride = Math.max(1, Math.floor(points.length / 1400));
    for (let i = index; i < points.length && tracks.length < 260; i += stride) {
      add(i + 1, points[i], this.isLost(index, t_s) || i % 17 === 0 ? 0 : i % 13 === 0 ? 3 : 1);
    }
    pointsOfMan(t_s).forEach((p, i) => i % 2 && add(900000 + i, p, 2));
    return { t_s, width: LENS.width, height: LENS.height, tracks };
  }

  agent(index, t_s) {
    const name = NAMES[index];
    const lost = this.isLost(index, t_s);
    const map = mapOf(index, t_s);
    const pose = this.inMap(index, t_s, cameraAt(index, t_s));
    const wobble = (size) => (this.random() - 0.5) * size;
    return {
      name, alive: !this.finishing, images: "none", scale_known: this.scaleKnown && map === 1, camera: index, map, group: lost ? -1 : groupsAt(t_s).findIndex((names) => names.includes(name)),
      frame: frameOf(map), state: lost ? "lost" : "tracking", why: lost ? WHY_LOST : "",
      rate_hz: 29.97 + wobble(0.4), frame_ms: 9.4 + index + wobble(1.4), kB_up_per_s: 27 + 2 * index + wobble(3),
      kB_down_per_s: 6.2 + wobble(1), lag_s: 0.041 + 0.01 * index + wobble(0.01), lost_percent: index === 1 ? 0.4 : 0,
      account: { captured: 300, tracked: 300 - index }, losses: index > 0 ? `${index} not sent in time` : "", path: pathOf(index, t_s), tracks: 262 + Math.round(wobble(20)), bound: lost ? 5 : 190 - 14 * index + Math.round(wobble(16)),
      clock_offset_ms: index === 0 ? null : 1.8 * index - 3 + wobble(0.1),
      pose: lost ? null : [...pose.t, ...quaternion(pose.r)],
      fov: [LENS.width, LENS.height, LENS.fx, LENS.fy, LENS.cx, LENS.cy],
    };
  }

  state(t_s) {
    const groups = groupsAt(t_s);
    const links = groups.flatMap((names) => names.flatMap((a, i) => names.slice(i + 1).map((b) => [a, b, 60 + Math.round(40 * Math.sin(t_s))])))
      .filter((pair) => pair.slice(0, 2).every((name) => !this.isLost(NAMES.indexOf(name), t_s)));
    const points = this.whole ? this.seen.points.length : this.seen.views.reduce((sum, views) => sum + (views > 0), 0);
    return {
      t_s, run: this.id, scale_known: this.scaleKnown, finishing: this.finishing, result: "result", join: "--domain 7",
      server: {
        ms_per_set: 7.6 + this.random(), points, ...(this.cameras.length === 0 ? NOTHING : { moving_points: 70, objects: 1, maps: mapOf(2, t_s), key_frames: Math.floor(8 + t_s * 2) }),
        memory_mib: 96 + Math.floor(t_s / 3), frame_sets: Math.floor(t_s * 30), left_out: 0,
      },
      agents: this.cameras.map((index) => this.agent(index, t_s)), groups, links,
    };
  }

  eventsBetween(from_s, to_s) { return EVENTS.filter(({ t_s }) => t_s > from_s && t_s <= to_s); }
}
