// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The floor as a grid of round lengths, borders of maps that stand beside each other, and links between cameras that share
// points.
import { BufferAttribute, BufferGeometry, Color, LineBasicMaterial, LineSegments, type Box3, Vector3 } from "three";

import { floorOf, type MapFrame } from "./frames";
import { Label, type Labels } from "./labels";
import { Strokes } from "./lines";
import type { Palette } from "./palette";

const CELLS = 24;
const MANY_SHARED = 150;

// 1, 2 or 5 times a power of ten, not below.
export function roundLength(length: number): number {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * ([1, 2, 5, 10].find((step) => step * power >= length * 0.999) ?? 10);
}

export class Floor {
  readonly object = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ vertexColors: true }));
  cell = 0;
  private centre = new Vector3();
  private palette: Palette | undefined;

  constructor() {
    this.object.frustumCulled = false;
    this.object.renderOrder = -1;
  }

  // Under all that is shown; the lines fade outwards.
  fit(box: Box3): void {
    const size = box.getSize(new Vector3());
    const cell = roundLength(Math.max(size.x, size.z, 1e-3) / 10);
    const middle = box.getCenter(new Vector3());
    const centre = new Vector3(Math.round(middle.x / cell) * cell, 0, Math.round(middle.z / cell) * cell);
    if (cell === this.cell && centre.distanceTo(this.centre) < 2.5 * cell) return;
    this.cell = cell;
    this.centre = centre;
    this.draw();
  }

  paint(palette: Palette): void {
    this.palette = palette;
    this.draw();
  }

  private draw(): void {
    if (!this.palette || this.cell === 0) return;
    const { grid, background } = this.palette;
    const half = CELLS / 2;
    const ends: number[] = [];
    const colours: number[] = [];
    const shade = new Color();
    const add = (i: number, j: number) => {
      ends.push(this.centre.x + i * this.cell, 0, this.centre.z + j * this.cell);
      shade.lerpColors(grid, background, Math.min(1, (Math.hypot(i, j) / half) ** 1.4));
      colours.push(shade.r, shade.g, shade.b);
    };
    for (let i = -half; i <= half; ++i) {
      for (let j = -half; j < half; ++j) {
        if (Math.hypot(i, j + 0.5) > half) continue;
        add(i, j);
        add(i, j + 1);
        add(j, i);
        add(j + 1, i);
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(ends), 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(colours), 3));
    this.object.geometry.dispose();
    this.object.geometry = geometry;
  }
}

export class Links {
  readonly strokes = new Strokes(1.5, { dashed: true });
  any = false;

  show(links: { from: Vector3; to: Vector3; shared: number }[], palette: Palette, size: number): void {
    const ends: number[] = [];
    const colours: number[] = [];
    const shade = new Color();
    for (const { from, to, shared } of links) {
      ends.push(...from.toArray(), ...to.toArray());
      shade.lerpColors(palette.background, palette.link, 0.25 + 0.75 * Math.min(1, shared / MANY_SHARED));
      for (let i = 0; i < 2; ++i) colours.push(shade.r, shade.g, shade.b);
    }
    this.any = ends.length > 0;
    this.strokes.material.dashSize = 0.5 * size;
    this.strokes.material.gapSize = 0.35 * size;
    this.strokes.set(ends, colours);
  }
}

// Where there are several maps: a frame around each, and its name.
export class Borders {
  readonly strokes = new Strokes(1);
  private readonly names = new Map<string, Label>();

  constructor(private readonly labels: Labels) {}

  show(frames: readonly MapFrame[]): void {
    const shown = frames.length > 1 ? frames : [];
    const ends: number[] = [];
    for (const frame of shown) {
      const corners = floorOf(frame);
      corners.forEach((corner, i) => ends.push(...corner.toArray(), ...corners[(i + 1) % corners.length]!.toArray()));
      this.name(frame).place.copy(corners[2]!).lerp(corners[3]!, 0.5);
    }
    this.strokes.set(ends);
    for (const [name, label] of this.names) label.visible = shown.some((frame) => frame.name === name);
  }

  paint(palette: Palette): void { this.strokes.paint(palette.gone); }

  private name(frame: MapFrame): Label {
    let label = this.names.get(frame.name);
    if (!label) this.names.set(frame.name, (label = this.labels.add(new Label("border"))));
    label.text(frame.name === "map" ? "main map" : frame.name.replace("_", " "), frame.ownUnit ? "own unit, drawn to fit" : "");
    return label;
  }
}
