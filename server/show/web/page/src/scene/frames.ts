// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The root frames of the maps, as they stand in the picture: y up, side by side, on one floor.
//
// A map has no up direction of its own. Cameras are mostly held level, so up is across the x axes of all of them, on the
// side of their mean -y; with cameras that all look one way it is that mean itself.
import { Box3, Group, Matrix3, Matrix4, Quaternion, Vector3 } from "three";

import type { Pose, RunState } from "../data/types";

const SETTLE_S = 10;      // of a map's life in which up is found better and better
const LEVEL = 0.02;       // how much x axes weigh: small is much
const GAP = 0.25;         // between maps, of their size
const SLACK = 0.06;       // a map stays where it is while that is good enough
const BORDER = 0.04;      // around a map, of its size
const BESIDE = 0.5;       // size of a map of its own unit, of that of the main map
const RESCALED = 1.4;     // it has become larger or smaller by so much: it is scaled anew

export interface MapFrame {
  name: string;
  group: Group;
  extent: Box3;           // of its points, rotated and not yet moved
  turned: Quaternion;
  scale: number;          // of the picture: maps of another unit are drawn to fit beside
  ownUnit: boolean;
  settled: boolean;
  ahead: Vector3 | undefined;
  used: boolean;
}

export class Frames {
  readonly root = new Group();
  readonly all = new Map<string, MapFrame>();
  private readonly nameOfMap = new Map<number, string>();
  version = 0;

  clear(): void {
    for (const frame of this.all.values()) this.root.remove(frame.group);
    this.all.clear();
    this.nameOfMap.clear();
    ++this.version;
  }

  of(name: string): MapFrame {
    let frame = this.all.get(name);
    if (!frame) {
      frame = { name, group: new Group(), extent: new Box3(), turned: new Quaternion(), scale: 1, ownUnit: name !== "map", settled: false, ahead: undefined, used: true };
      frame.group.matrixAutoUpdate = false;
      this.all.set(name, frame);
      this.root.add(frame.group);
      ++this.version;
    }
    return frame;
  }

  takeState(state: RunState): void {
    this.nameOfMap.clear();
    for (const agent of state.agents) if (agent.map !== 0) this.nameOfMap.set(agent.map, agent.frame);
    const metric = new Set(state.agents.filter((agent) => agent.scale_known).map(({ frame }) => frame));
    for (const frame of this.all.values()) frame.ownUnit = frame.name !== "map" && !(metric.has(frame.name) && state.scale_known);
    const named = new Set(this.nameOfMap.values());
    for (const frame of this.all.values()) frame.used = named.size === 0 || named.has(frame.name) || frame.name === "map";
  }

  // `main` is the map that most points are in: it is `map` where no camera says otherwise.
  nameOf(map: number, main: number): string {
    const name = this.nameOfMap.get(map);
    if (name !== undefined) return name;
    const taken = [...this.nameOfMap.values()].includes("map");
    return map === main && !taken ? "map" : `map_${map}`;
  }

  // Finds up and the heading from poses of cameras, map from camera.
  level(name: string, poses: readonly Pose[], again = false): void {
    const frame = this.of(name);
    if ((frame.settled && !again) || poses.length === 0) return;
    const up = upOf(poses);
    frame.ahead ??= new Vector3(0, 0, 1).applyQuaternion(lookOf(poses[0]!));
    const ahead = frame.ahead.clone().addScaledVector(up, -frame.ahead.dot(up));
    if (ahead.lengthSq() < 1e-6) ahead.set(up.y, up.z, up.x).addScaledVector(up, -up.dot(ahead));
    const back = ahead.normalize().negate();
    const right = up.clone().cross(back);
    // Rows: what becomes x, y, z of the picture.
    const rows = new Matrix4().set(right.x, right.y, right.z, 0, up.x, up.y, up.z, 0, back.x, back.y, back.z, 0, 0, 0, 0, 1);
    const turned = new Quaternion().setFromRotationMatrix(rows);
    if (turned.angleTo(frame.turned) < 0.005) return;
    frame.turned.copy(turned);
    this.put(frame, frame.group.position);
    ++this.version;
  }

  settle(name: string, age_s: number): void {
    if (age_s > SETTLE_S) this.of(name).settled = true;
  }

  // Those that are shown, the main one first.
  shown(): MapFrame[] {
    const frames = [...this.all.values()].filter((frame) => frame.used && !frame.extent.isEmpty());
    return frames.sort((a, b) => (a.name === "map" ? -1 : b.name === "map" ? 1 : a.name < b.name ? -1 : 1));
  }

  // Where maps stand beside each other; called when what they hold has changed.
  arrange(): void {
    const frames = this.shown();
    let from = 0;
    for (const [index, frame] of frames.entries()) {
      this.rescale(frame, frames[0]!);
      const extent = scaled(frame);
      const size = extent.getSize(new Vector3());
      const gap = GAP * Math.max(size.x, size.z);
      const x = index === 0 ? 0 : from + gap - extent.min.x;
      const z = index === 0 ? 0 : -(extent.min.z + extent.max.z) / 2;
      const wanted = new Vector3(x, -extent.min.y, z);
      if (wanted.distanceTo(frame.group.position) > SLACK * size.length()) {
        this.put(frame, wanted);
        ++this.version;
      }
      from = frame.group.position.x + extent.max.x;
    }
    for (const frame of this.all.values()) frame.group.visible = frame.used;
  }

  // All that is shown.
  extent(): Box3 { return this.shown().reduce((box, frame) => box.union(boxOf(frame)), new Box3()); }

  // Nobody knows how large the one is beside the other.
  private rescale(frame: MapFrame, main: MapFrame): void {
    const wanted = frame === main || !frame.ownUnit ? 1 : (BESIDE * widthOf(main)) / Math.max(1e-9, widthOf(frame));
    const by = wanted / frame.scale;
    if (wanted !== 1 && by < RESCALED && by > 1 / RESCALED) return;
    if (Math.abs(by - 1) < 1e-9) return;
    frame.scale = wanted;
    this.put(frame, frame.group.position);
    ++this.version;
  }

  private put(frame: MapFrame, position: Vector3): void {
    frame.group.position.copy(position);
    frame.group.quaternion.copy(frame.turned);
    frame.group.scale.setScalar(frame.scale);
    frame.group.updateMatrix();
    frame.group.matrixWorldNeedsUpdate = true;
    frame.group.updateMatrixWorld(true);
  }
}

function scaled({ extent, scale }: MapFrame): Box3 { return new Box3(extent.min.clone().multiplyScalar(scale), extent.max.clone().multiplyScalar(scale)); }

// Where it stands in the picture.
export function boxOf(frame: MapFrame): Box3 { return scaled(frame).translate(frame.group.position); }

// The corners of the border that is drawn around it.
export function floorOf(frame: MapFrame): Vector3[] {
  const { min, max } = boxOf(frame);
  const by = BORDER * Math.max(max.x - min.x, max.z - min.z);
  return [[min.x - by, min.z - by], [max.x + by, min.z - by], [max.x + by, max.z + by], [min.x - by, max.z + by]].map(([x, z]) => new Vector3(x, 0, z));
}

function widthOf({ extent }: MapFrame): number { return Math.max(extent.max.x - extent.min.x, extent.max.z - extent.min.z); }

const BASE_FROM_OPTICAL = new Quaternion(-0.5, 0.5, -0.5, 0.5);

// How the camera of a base_link (x ahead, y left, z up) is turned: x right, y down, z ahead.
export function lookOf(pose: Pose): Quaternion { return quaternionOf(pose).multiply(BASE_FROM_OPTICAL); }

export function quaternionOf({ orientation: q }: Pose): Quaternion { return new Quaternion(q.x, q.y, q.z, q.w); }

function upOf(poses: readonly Pose[]): Vector3 {
  const up = new Vector3();
  const m = new Array<number>(9).fill(0);
  for (const pose of poses) {
    const q = lookOf(pose);
    const x = new Vector3(1, 0, 0).applyQuaternion(q).toArray();
    up.sub(new Vector3(0, 1, 0).applyQuaternion(q));
    for (let i = 0; i < 9; ++i) m[i] = m[i]! + (x[Math.floor(i / 3)]! * x[i % 3]!) / poses.length;
  }
  for (const i of [0, 4, 8]) m[i] = m[i]! + LEVEL;
  const inverse = new Matrix3().fromArray(m).invert();
  return up.normalize().applyMatrix3(inverse).normalize();
}
