// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The static points of all maps: one geometry, rewritten in place.
import { Box3, BufferAttribute, BufferGeometry, DynamicDrawUsage, Matrix4, Points as Drawn, Vector3 } from "three";

import { column, type Cloud } from "../data/cloud";
import type { Frames } from "./frames";
import type { Palette } from "./palette";
import { COLOUR_BY, pointMaterial, type ColourBy } from "./point_shader";

const SAMPLE = 3000;         // points that sizes are taken from
const TRIMMED = 0.02;        // of a sample, on either side
const ENOUGH = 20;           // points, to know how certain they are
const LEAST_RANGE = 2 << 23;  // a factor of four
const MANY_VIEWS = 40;
const FRESH_MS = 1400;

interface Columns {
  x: Float32Array; y: Float32Array; z: Float32Array; sigma: Float32Array;
  id: Uint32Array; map: Uint32Array; state: Uint8Array; views: Uint16Array;
}

function columnsOf(size: number): Columns {
  return {
    x: new Float32Array(size), y: new Float32Array(size), z: new Float32Array(size), sigma: new Float32Array(size),
    id: new Uint32Array(size), map: new Uint32Array(size), state: new Uint8Array(size), views: new Uint16Array(size),
  };
}

const OCTETS = new DataView(new ArrayBuffer(4));

// The number that has these octets as a float.
function floatOf(octets: number): number {
  OCTETS.setUint32(0, octets);
  return OCTETS.getFloat32(0);
}

export interface PointFigures { id: number; map: number; onTrial: boolean; sigma: number; views: number; position: number[] }

export class Points {
  readonly material = pointMaterial();
  readonly object: Drawn;
  count = 0;
  version = 0;                       // of positions and looks
  position = new Float32Array(0);
  look = new Uint8Array(0);          // state, certainty, views, new
  by: ColourBy = "state";
  private geometry = new BufferGeometry();
  private columns = columnsOf(0);
  private range = [0x3a83126f, 0x3dcccccd];  // of the logarithm of sigma: 0.001 to 0.1
  private newest = 0;
  private fresh_ms = -Infinity;
  private main = 0;

  constructor() {
    this.object = new Drawn(this.geometry, this.material);
    this.object.frustumCulled = false;
    this.reserve(4096);
  }

  clear(): void {
    this.count = this.newest = 0;
    ++this.version;
    this.geometry.setDrawRange(0, 0);
  }

  // Then place() has to follow.
  apply(cloud: Cloud): void {
    this.reserve(cloud.count);
    const { columns } = this;
    columns.map.fill(0);
    for (const name of Object.keys(columns) as (keyof Columns)[]) column(cloud, name, columns[name]);
    this.count = cloud.count;
    this.main = this.mostNumerous();
    this.measure();
    this.writeLook();
  }

  // Writes positions, as the maps stand now.
  place(frames: Frames): void {
    const { x, y, z, map } = this.columns;
    const { position, count } = this;
    const matrices = new Map<number, number[]>();
    let last = -1;
    let m: number[] = [];
    for (let i = 0, at = 0; i < count; ++i, at += 3) {
      if (map[i] !== last) {
        last = map[i]!;
        m = matrices.get(last) ?? matrixOf(frames, frames.nameOf(last, this.main));
        matrices.set(last, m);
      }
      const px = x[i]!;
      const py = y[i]!;
      const pz = z[i]!;
      position[at] = m[0]! * px + m[4]! * py + m[8]! * pz + m[12]!;
      position[at + 1] = m[1]! * px + m[5]! * py + m[9]! * pz + m[13]!;
      position[at + 2] = m[2]! * px + m[6]! * py + m[10]! * pz + m[14]!;
    }
    this.send();
  }

  // Adds to the boxes of the maps, without what lies far out.
  measureFrames(frames: Frames): void {
    const { x, y, z, map } = this.columns;
    const stride = Math.max(1, Math.floor(this.count / SAMPLE));
    const samples = new Map<number, Vector3[]>();
    for (let i = 0; i < this.count; i += stride) {
      let own = samples.get(map[i]!);
      if (!own) samples.set(map[i]!, (own = []));
      own.push(new Vector3(x[i], y[i], z[i]));
    }
    for (const [id, points] of samples) {
      const frame = frames.of(frames.nameOf(id, this.main));
      for (const p of points) p.applyQuaternion(frame.turned);
      const ends = (axis: "x" | "y" | "z") => {
        const sorted = points.map((p) => p[axis]).sort((a, b) => a - b);
        const cut = Math.floor(sorted.length * TRIMMED);
        return [sorted[cut]!, sorted[sorted.length - 1 - cut]!];
      };
      const [ex, ey, ez] = [ends("x"), ends("y"), ends("z")];
      frame.extent.union(new Box3(new Vector3(ex[0], ey[0], ez[0]), new Vector3(ex[1], ey[1], ez[1])));
    }
  }

  figures(index: number): PointFigures {
    const { x, y, z, sigma, id, map, state, views } = this.columns;
    return {
      id: id[index]!, map: map[index]!, onTrial: state[index] === 1, sigma: sigma[index]!, views: views[index]!,
      position: [x[index]!, y[index]!, z[index]!],
    };
  }

  frameOf(index: number, frames: Frames): string { return frames.nameOf(this.columns.map[index]!, this.main); }
  indexOf(id: number): number { return this.columns.id.subarray(0, this.count).indexOf(id); }
  placeOf(index: number): Vector3 { return new Vector3().fromArray(this.position, 3 * index); }

  // The point nearest to a place on the screen, and of those that are about as near the one in front; -1: none.
  pick(clip: Matrix4, x_px: number, y_px: number, width: number, height: number, within_px: number): number {
    const m = clip.elements;
    const { position } = this;
    const least = this.material.uniforms["leastCertain"]!.value as number;
    let best = -1;
    let bestCost = within_px;
    for (let i = 0, at = 0; i < this.count; ++i, at += 3) {
      const [x, y, z] = [position[at]!, position[at + 1]!, position[at + 2]!];
      const w = m[3]! * x + m[7]! * y + m[11]! * z + m[15]!;
      if (w <= 0.01 || this.look[4 * i + 1]! < 255 * least) continue;
      const dx = ((m[0]! * x + m[4]! * y + m[8]! * z + m[12]!) / w + 1) * 0.5 * width - x_px;
      const dy = (1 - (m[1]! * x + m[5]! * y + m[9]! * z + m[13]!) / w) * 0.5 * height - y_px;
      if (Math.abs(dx) > within_px || Math.abs(dy) > within_px) continue;
      const cost = Math.hypot(dx, dy) + 0.4 * w;
      if (Math.hypot(dx, dy) < within_px && (best < 0 || cost < bestCost)) [best, bestCost] = [i, cost];
    }
    return best;
  }

  // Of the scales of colours: standard deviations of the least and the most certain, height, views.
  scaleOf(by: ColourBy): [low: number, high: number] {
    if (by === "certainty") return [floatOf(this.range[1]!), floatOf(this.range[0]!)];
    return by === "height" ? [0, this.ceiling - this.floor] : [0, MANY_VIEWS];
  }

  // The proven points of the main map.
  *proven(): Generator<PointFigures> {
    for (let i = 0; i < this.count; ++i) {
      const figures = this.figures(i);
      if (figures.map === this.main && !figures.onTrial) yield figures;
    }
  }

  get floor(): number { return this.material.uniforms["floorHeight"]!.value as number; }
  get ceiling(): number { return this.material.uniforms["ceilingHeight"]!.value as number; }

  colourBy(by: ColourBy): void {
    this.by = by;
    this.material.uniforms["colourBy"]!.value = COLOUR_BY.indexOf(by);
  }

  paint(palette: Palette): void {
    const { uniforms } = this.material;
    uniforms["background"]!.value = palette.background;
    uniforms["fixedColour"]!.value = palette.fixed;
    uniforms["trialColour"]!.value = palette.trial;
    uniforms["freshColour"]!.value = palette.accent;
    [uniforms["rampLow"]!.value, uniforms["rampMiddle"]!.value, uniforms["rampHigh"]!.value] = palette.ramp;
  }

  // True while new points still shine.
  fade(now_ms: number): boolean {
    const left = 1 - (now_ms - this.fresh_ms) / FRESH_MS;
    const { value } = this.material.uniforms["fresh"]!;
    this.material.uniforms["fresh"]!.value = Math.max(0, left);
    return left > 0 || value > 0;
  }

  private reserve(size: number): void {
    if (size <= this.columns.x.length) return;
    const room = 2 ** Math.ceil(Math.log2(size));
    this.columns = columnsOf(room);
    this.position = new Float32Array(3 * room);
    this.look = new Uint8Array(4 * room);
    this.geometry.dispose();
    this.geometry = new BufferGeometry();
    this.geometry.setAttribute("position", new BufferAttribute(this.position, 3).setUsage(DynamicDrawUsage));
    this.geometry.setAttribute("look", new BufferAttribute(this.look, 4, true).setUsage(DynamicDrawUsage));
    this.object.geometry = this.geometry;
  }

  private mostNumerous(): number {
    const counts = new Map<number, number>();
    for (let i = 0; i < this.count; i += 7) counts.set(this.columns.map[i]!, (counts.get(this.columns.map[i]!) ?? 0) + 1);
    return [...counts].sort((a, b) => b[1] - a[1])[0]?.[0] ?? 0;
  }

  // The octets of a float, read as a whole number, are about its logarithm; that is enough here, and fast.
  private logarithms(): Uint32Array { return new Uint32Array(this.columns.sigma.buffer, 0, this.count); }

  private measure(): void {
    const logarithms = this.logarithms();
    const stride = Math.max(1, Math.floor(this.count / SAMPLE));
    const sample: number[] = [];
    for (let i = 0; i < this.count; i += stride) if (this.columns.sigma[i]! > 0) sample.push(logarithms[i]!);
    if (sample.length < ENOUGH) return;
    sample.sort((a, b) => a - b);
    const low = sample[Math.floor(0.05 * sample.length)]!;
    this.range = [low, Math.max(low + LEAST_RANGE, sample[Math.floor(0.95 * sample.length)]!)];
  }

  private writeLook(): void {
    const { state, views, id } = this.columns;
    const { count, look, newest: before } = this;
    const logarithms = this.logarithms();
    const [low, high] = this.range as [number, number];
    const scale = 255 / (high - low);
    let newest = 0;
    for (let i = 0, at = 0; i < count; ++i, at += 4) {
      const certain = 255 - (logarithms[i]! - low) * scale;
      const many = views[i]! * (255 / MANY_VIEWS);
      look[at] = state[i] === 0 ? 0 : 255;
      look[at + 1] = certain < 0 ? 0 : certain > 255 ? 255 : certain;
      look[at + 2] = many > 255 ? 255 : many;
      look[at + 3] = before > 0 && id[i]! > before ? 255 : 0;
      if (id[i]! > newest) newest = id[i]!;
    }
    if (newest > before && before > 0) this.fresh_ms = performance.now();
    this.newest = newest;
  }

  private send(): void {
    ++this.version;
    const { attributes } = this.geometry;
    for (const [name, width] of [["position", 3], ["look", 4]] as const) {
      const attribute = attributes[name] as BufferAttribute;
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, width * this.count);
      attribute.needsUpdate = true;
    }
    this.geometry.setDrawRange(0, this.count);
  }
}

function matrixOf(frames: Frames, name: string): number[] {
  const frame = frames.of(name);
  // What is of no map that is shown goes out of sight.
  return frame.used ? frame.group.matrix.elements : new Matrix4().makeScale(0, 0, 0).setPosition(1e9, 1e9, 1e9).elements;
}
