// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What moves as one: a box, an arrow of its velocity, the way it came.
import { BoxGeometry, ConeGeometry, Group, Matrix4, Mesh, MeshBasicMaterial, Quaternion, Vector3 } from "three";

import type { Marker, MarkerArray } from "../data/types";
import { type Frames, quaternionOf } from "./frames";
import { Label, type Labels } from "./labels";
import { Strokes, strip } from "./lines";
import type { Palette } from "./palette";

const ARROW = 0;
const CUBE = 1;
const ADD = 0;
const TRAIL_S = 20;
const SPEED_OVER_S = 1;
const JUMP_S = 1;           // a trail that misses so much begins anew

const EDGES = (() => {
  const corner = (i: number) => [(i & 1) - 0.5, ((i >> 1) & 1) - 0.5, ((i >> 2) & 1) - 0.5];
  const pairs = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];
  return pairs.flatMap(([a, b]) => [...corner(a!), ...corner(b!)]);
})();

class ObjectMark {
  readonly body = new Group();
  readonly box = new Group();
  readonly edges = new Strokes(1.5);
  readonly trail = new Strokes(2, { opacity: 0.5 });
  readonly shaft = new Strokes(3);
  readonly fill = new Mesh(new BoxGeometry(1, 1, 1), new MeshBasicMaterial({ transparent: true, opacity: 0.1, depthWrite: false }));
  readonly tip = new Mesh(new ConeGeometry(0.5, 1, 12).translate(0, -0.5, 0), new MeshBasicMaterial());
  readonly label: Label;
  centres: { t_s: number; place: number[] }[] = [];
  size = new Vector3();
  height = 0;

  constructor(readonly id: number, labels: Labels) {
    this.label = labels.add(new Label("object"));
    this.label.element.dataset["object"] = String(id);
    this.edges.set(EDGES);
    this.box.matrixAutoUpdate = false;
    this.box.add(this.edges.object, this.fill);
    this.body.add(this.box, this.trail.object, this.shaft.object, this.tip);
  }

  takeBox(marker: Marker, t_s: number): void {
    const { position: p } = marker.pose;
    this.size.set(marker.scale.x, marker.scale.y, marker.scale.z);
    this.box.matrix.compose(new Vector3(p.x, p.y, p.z), quaternionOf(marker.pose), this.size);
    const last = this.centres.at(-1);
    if (last && (t_s < last.t_s || t_s - last.t_s > JUMP_S)) this.centres.length = 0;
    if (!last || t_s !== last.t_s) this.centres.push({ t_s, place: [p.x, p.y, p.z] });
    while (this.centres.length > 2 && t_s - this.centres[0]!.t_s > TRAIL_S) this.centres.shift();
    const stride = Math.ceil(this.centres.length / 150);
    const shown = this.centres.filter((_, i) => i % stride === 0 || i === this.centres.length - 1);
    this.trail.set(strip(shown.map(({ place }) => place)));
  }

  takeArrow(marker: Marker): void {
    const [from, to] = ends(marker);
    const along = to.clone().sub(from);
    const length = along.length();
    this.tip.visible = length > 1e-6;
    const head = Math.min(0.35 * length, 0.3 * Math.max(this.size.x, this.size.y, this.size.z));
    this.shaft.set(length > 1e-6 ? [...from.toArray(), ...to.toArray()] : []);
    this.tip.position.copy(to);
    this.tip.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), along.normalize());
    this.tip.scale.set(0.6 * head, head, 0.6 * head);
  }

  speed(): number | undefined {
    const last = this.centres.at(-1);
    const first = last && this.centres.find(({ t_s }) => last.t_s - t_s <= SPEED_OVER_S);
    if (!first || last.t_s - first.t_s < 0.2 * SPEED_OVER_S) return undefined;
    return new Vector3().fromArray(last.place).distanceTo(new Vector3().fromArray(first.place)) / (last.t_s - first.t_s);
  }

  placeLabel(): void {
    this.label.visible = this.body.parent?.visible === true;
    if (!this.label.visible) return;
    this.label.place.setFromMatrixPosition(new Matrix4().multiplyMatrices(this.body.parent!.matrixWorld, this.box.matrix));
    this.label.place.y += 0.5 * this.size.length();
  }
}

function ends(marker: Marker): [Vector3, Vector3] {
  const [a, b] = marker.points;
  const origin = new Vector3(marker.pose.position.x, marker.pose.position.y, marker.pose.position.z);
  const turn: Quaternion = quaternionOf(marker.pose);
  const placed = (x: number, y: number, z: number) => new Vector3(x, y, z).applyQuaternion(turn).add(origin);
  if (a && b) return [placed(a.x, a.y, a.z), placed(b.x, b.y, b.z)];
  return [origin, placed(marker.scale.x, 0, 0)];
}

export class Objects {
  readonly all = new Map<number, ObjectMark>();
  private palette: Palette | undefined;

  constructor(private readonly labels: Labels) {}

  show(t_s: number, array: MarkerArray, frames: Frames): void {
    const seen = new Set<number>();
    for (const marker of array.markers) if (marker.type === CUBE && marker.action === ADD) {
      seen.add(marker.id);
      const mark = this.markOf(marker.id);
      frames.of(marker.header.frame_id).group.add(mark.body);
      mark.takeBox(marker, t_s);
    }
    for (const marker of array.markers) {
      if (marker.type === ARROW && marker.action === ADD) this.all.get(marker.id)?.takeArrow(marker);
    }
    for (const id of [...this.all.keys()]) if (!seen.has(id)) this.remove(id);
  }

  clear(): void { for (const id of [...this.all.keys()]) this.remove(id); }

  name(unit: string): void {
    for (const mark of this.all.values()) {
      const speed = mark.speed();
      mark.label.text(`object ${mark.id}`, speed === undefined ? "" : `${speed.toFixed(1)} ${unit}/s`);
    }
  }

  paint(palette: Palette): void {
    this.palette = palette;
    for (const mark of this.all.values()) this.paintOne(mark);
  }

  placeLabels(): void { for (const mark of this.all.values()) mark.placeLabel(); }

  private markOf(id: number): ObjectMark {
    let mark = this.all.get(id);
    if (!mark) {
      this.all.set(id, (mark = new ObjectMark(id, this.labels)));
      this.paintOne(mark);
    }
    return mark;
  }

  private paintOne(mark: ObjectMark): void {
    if (!this.palette) return;
    for (const strokes of [mark.edges, mark.trail, mark.shaft]) strokes.paint(this.palette.moving);
    for (const mesh of [mark.fill, mark.tip]) (mesh.material as MeshBasicMaterial).color.copy(this.palette.moving);
    mark.label.element.style.setProperty("--colour", `#${this.palette.moving.getHexString()}`);
  }

  private remove(id: number): void {
    const mark = this.all.get(id);
    if (!mark) return;
    this.labels.remove(mark.label);
    mark.body.removeFromParent();
    this.all.delete(id);
  }
}
