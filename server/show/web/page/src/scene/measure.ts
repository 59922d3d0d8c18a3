// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Where picked things are, and the line between two of them.
import { Vector3 } from "three";

import { isKnown, positionCovariance } from "./covariance";
import { Label, type Labels } from "./labels";
import { Strokes } from "./lines";
import type { Palette } from "./palette";
import type { Picked } from "./pick";
import type { View } from "./view";

export interface Place {
  frame: string;
  position: number[];     // in that frame
  covariance: number[] | undefined;  // xx xy xz yy yz zz
}

const ball = (sigma: number): number[] => [sigma ** 2 / 3, 0, 0, sigma ** 2 / 3, 0, sigma ** 2 / 3];

// undefined: it is not in the picture at this instant.
export function placeOf(view: View, picked: Picked): Place | undefined {
  if (picked.kind === "point") {
    const index = view.points.indexOf(picked.id);
    if (index < 0) return undefined;
    const { sigma, position } = view.points.figures(index);
    return { frame: view.points.frameOf(index, view.frames), position, covariance: ball(sigma) };
  }
  if (picked.kind === "moving") {
    const { now, root, frame } = view.moving;
    const at = now?.id.indexOf(picked.id) ?? -1;
    if (!now || at < 0 || !root.parent) return undefined;
    return { frame, position: [...now.xyz.subarray(3 * at, 3 * at + 3)], covariance: ball(now.sigma[at]!) };
  }
  if (picked.kind !== "camera") return undefined;
  const mark = view.cameras.get(picked.name);
  if (!mark?.pose) return undefined;
  const { x, y, z } = mark.pose.position;
  return { frame: mark.frame, position: [x, y, z], covariance: isKnown(mark.covariance) ? positionCovariance(mark.covariance) : undefined };
}

// With its standard deviation, where the covariances are known.
export function distanceOf(a: Place, b: Place): { length: number; sigma: number | undefined } {
  const along = a.position.map((value, i) => b.position[i]! - value) as [number, number, number];
  const length = Math.hypot(...along);
  if (!a.covariance || !b.covariance || length === 0) return { length, sigma: undefined };
  const [x, y, z] = along.map((value) => value / length) as [number, number, number];
  const sums = a.covariance.map((value, i) => value + b.covariance![i]!) as [number, number, number, number, number, number];
  const [xx, xy, xz, yy, yz, zz] = sums;
  const variance = xx * x * x + yy * y * y + zz * z * z + 2 * (xy * x * y + xz * x * z + yz * y * z);
  return { length, sigma: Math.sqrt(Math.max(0, variance)) };
}

export class Ruler {
  readonly strokes = new Strokes(2);
  private readonly label: Label;

  constructor(labels: Labels) {
    this.label = labels.add(new Label("length"));
    this.label.visible = false;
  }

  show(view: View, a: Place, b: Place, text: string): void {
    const [from, to] = [a, b].map(({ frame, position }) => new Vector3(...position).applyMatrix4(view.frames.of(frame).group.matrixWorld)) as [Vector3, Vector3];
    this.strokes.set([...from.toArray(), ...to.toArray()]);
    this.label.text(text);
    this.label.place.copy(from).lerp(to, 0.5);
    this.label.visible = true;
  }

  hide(): void {
    this.strokes.set([]);
    this.label.visible = false;
  }

  paint(palette: Palette): void { this.strokes.paint(palette.accent); }
}
