// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Lines of a width in pixels, rewritten in place.
import { BufferAttribute, BufferGeometry, type Color, DynamicDrawUsage, LineBasicMaterial, LineSegments } from "three";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";

// A few segments, of any width.
export class Strokes {
  readonly material: LineMaterial;
  readonly object: LineSegments2;

  constructor(width_px: number, options: { dashed?: boolean; opacity?: number } = {}) {
    const opacity = options.opacity ?? 1;
    this.material = new LineMaterial({ linewidth: width_px, dashed: options.dashed ?? false, transparent: opacity < 1, opacity });
    this.object = new LineSegments2(new LineSegmentsGeometry(), this.material);
    this.object.frustumCulled = false;
    this.object.visible = false;
  }

  any = false;  // something is to be drawn

  // Pairs of ends, three numbers each; colours likewise.
  set(positions: readonly number[], colours?: readonly number[]): void {
    this.object.visible = this.any = positions.length > 0;
    if (!this.any) return;
    this.object.geometry.dispose();
    const geometry = new LineSegmentsGeometry();
    geometry.setPositions(positions as number[]);
    if (colours) geometry.setColors(colours as number[]);
    this.material.vertexColors = colours !== undefined;
    this.object.geometry = geometry;
    if (this.material.dashed) this.object.computeLineDistances();
  }

  paint(colour: Color): void { this.material.color.copy(colour); }
}

export function strip(points: readonly (readonly number[])[]): number[] {
  const out: number[] = [];
  for (let i = 1; i < points.length; ++i) out.push(...points[i - 1]!, ...points[i]!);
  return out;
}

// Thousands of segments, one pixel wide.
export class Hairs {
  readonly object: LineSegments;
  private position = new Float32Array(0);
  private colour = new Float32Array(0);
  private geometry = new BufferGeometry();
  private used = 0;

  constructor() {
    this.object = new LineSegments(this.geometry, new LineBasicMaterial({ vertexColors: true }));
    this.object.frustumCulled = false;
  }

  // Room for so many segments; then add() and at the end send().
  begin(segments: number): void {
    this.used = 0;
    if (6 * segments <= this.position.length) return;
    const room = 6 * 2 ** Math.ceil(Math.log2(segments));
    this.position = new Float32Array(room);
    this.colour = new Float32Array(room);
    this.geometry.dispose();
    this.geometry = new BufferGeometry();
    this.geometry.setAttribute("position", new BufferAttribute(this.position, 3).setUsage(DynamicDrawUsage));
    this.geometry.setAttribute("color", new BufferAttribute(this.colour, 3).setUsage(DynamicDrawUsage));
    this.object.geometry = this.geometry;
  }

  add(from: ArrayLike<number>, fromAt: number, to: ArrayLike<number>, toAt: number, r: number, g: number, b: number): void {
    for (let i = 0; i < 3; ++i) {
      this.position[this.used + i] = from[fromAt + i]!;
      this.position[this.used + 3 + i] = to[toAt + i]!;
    }
    for (let i = 0; i < 6; i += 3) this.colour.set([r, g, b], this.used + i);
    this.used += 6;
  }

  send(): void {
    for (const attribute of Object.values(this.geometry.attributes)) {
      const buffer = attribute as BufferAttribute;
      buffer.clearUpdateRanges();
      buffer.addUpdateRange(0, this.used);
      buffer.needsUpdate = true;
    }
    this.geometry.setDrawRange(0, this.used / 3);
  }
}
