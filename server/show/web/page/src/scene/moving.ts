// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Points that move, with the ways they came of the last seconds.
import { BufferAttribute, BufferGeometry, Color, DynamicDrawUsage, Group, Points as Drawn, PointsMaterial } from "three";

import { column, type Cloud } from "../data/cloud";
import type { Frames } from "./frames";
import { Hairs } from "./lines";
import type { Palette } from "./palette";

export const TRAIL_S = 2.5;
const POINT_PX = 3.5;
const MOST_SEGMENTS = 30000;

interface Columns { count: number; xyz: Float32Array; id: Uint32Array; object: Uint32Array; sigma: Float32Array }

const cache = new WeakMap<Cloud, Columns>();

function columnsOf(cloud: Cloud): Columns {
  const known = cache.get(cloud);
  if (known) return known;
  const { count } = cloud;
  const axes = ["x", "y", "z"].map((name) => {
    const out = new Float32Array(count);
    column(cloud, name, out);
    return out;
  });
  const xyz = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) for (let k = 0; k < 3; ++k) xyz[3 * i + k] = axes[k]![i]!;
  const columns = { count, xyz, id: new Uint32Array(count), object: new Uint32Array(count), sigma: new Float32Array(count) };
  column(cloud, "id", columns.id);
  column(cloud, "object", columns.object);
  column(cloud, "sigma", columns.sigma);
  cache.set(cloud, columns);
  return columns;
}

export interface Sample { t_s: number; cloud: Cloud }

export class Moving {
  readonly root = new Group();
  now: Columns | undefined;
  frame = "map";
  private readonly points: Drawn;
  private readonly hairs = new Hairs();
  private readonly material = new PointsMaterial({ size: POINT_PX, sizeAttenuation: false });
  private colour = new Color();
  private background = new Color();

  constructor() {
    this.points = new Drawn(new BufferGeometry(), this.material);
    this.points.frustumCulled = false;
    this.root.add(this.points, this.hairs.object);
  }

  // Samples in the order of time, the last one now.
  show(samples: readonly Sample[], frames: Frames): void {
    const last = samples.at(-1);
    this.root.visible = last !== undefined;
    this.now = last && columnsOf(last.cloud);
    if (!last || !this.now) return;
    this.frame = last.cloud.frame;
    frames.of(this.frame).group.add(this.root);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(this.now.xyz, 3).setUsage(DynamicDrawUsage));
    this.points.geometry.dispose();
    this.points.geometry = geometry;
    this.drawTrails(samples, last.t_s);
  }

  pixelRatio(ratio: number): void { this.material.size = POINT_PX * ratio; }

  paint(palette: Palette): void {
    this.colour.copy(palette.moving);
    this.background.copy(palette.background);
    this.material.color.copy(palette.moving);
  }

  private drawTrails(samples: readonly Sample[], now_s: number): void {
    const total = samples.reduce((sum, { cloud }) => sum + cloud.count, 0);
    const stride = Math.ceil(total / MOST_SEGMENTS);
    const kept = samples.filter((_, i) => (samples.length - 1 - i) % stride === 0);
    this.hairs.begin(Math.max(1, kept.reduce((sum, { cloud }) => sum + cloud.count, 0)));
    let before = new Map<number, number>();
    let beforeXyz: Float32Array = new Float32Array(0);
    const shade = new Color();
    for (const { t_s, cloud } of kept) {
      const { count, xyz, id } = columnsOf(cloud);
      shade.lerpColors(this.background, this.colour, 0.08 + 0.72 * Math.max(0, 1 - (now_s - t_s) / TRAIL_S) ** 1.5);
      const here = new Map<number, number>();
      for (let i = 0; i < count; ++i) {
        here.set(id[i]!, i);
        const at = before.get(id[i]!);
        if (at !== undefined) this.hairs.add(beforeXyz, 3 * at, xyz, 3 * i, shade.r, shade.g, shade.b);
      }
      before = here;
      beforeXyz = xyz;
    }
    this.hairs.send();
  }
}
