// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What is picked: a ring around it, and the ellipsoid of its covariance at three standard deviations.
import { Group, Matrix3, Matrix4, Mesh, MeshBasicMaterial, SphereGeometry, Vector3 } from "three";

import { Label, type Labels } from "./labels";
import { Strokes } from "./lines";
import type { Palette } from "./palette";

export const DRAWN_SIGMAS = 3;
const CIRCLE = 48;

function circles(): number[] {
  const out: number[] = [];
  for (let axis = 0; axis < 3; ++axis) {
    for (let i = 0; i < CIRCLE; ++i) {
      for (const k of [i, i + 1]) {
        const a = (2 * Math.PI * k) / CIRCLE;
        const p = [0, 0, 0];
        p[(axis + 1) % 3] = Math.cos(a);
        p[(axis + 2) % 3] = Math.sin(a);
        out.push(...p);
      }
    }
  }
  return out;
}

export class SelectionMark {
  readonly body = new Group();
  readonly ring: Label;
  private readonly lines = new Strokes(1.5, { opacity: 0.9 });
  private readonly fill = new Mesh(new SphereGeometry(1, 24, 16), new MeshBasicMaterial({ transparent: true, opacity: 0.14, depthWrite: false }));

  constructor(labels: Labels) {
    this.ring = labels.add(new Label("ring"));
    this.ring.visible = false;
    this.lines.set(circles());
    this.body.add(this.lines.object, this.fill);
    this.body.matrixAutoUpdate = false;
    this.body.visible = false;
  }

  // covariance: xx xy xz yy yz zz in the frame of `parent`, where the mark is added.
  show(parent: Group, at: readonly number[], covariance: readonly number[]): void {
    const [xx, xy, xz, yy, yz, zz] = covariance as [number, number, number, number, number, number];
    const { values, vectors } = eigen([xx, xy, xz, xy, yy, yz, xz, yz, zz]);
    const axes = vectors.map((axis, i) => axis.multiplyScalar(DRAWN_SIGMAS * Math.sqrt(Math.max(values[i]!, 1e-14)))) as [Vector3, Vector3, Vector3];
    this.body.matrix.makeBasis(...axes).setPosition(at[0]!, at[1]!, at[2]!);
    parent.add(this.body);
    this.body.updateMatrixWorld(true);
    this.body.visible = true;
    this.ring.visible = true;
    this.ring.place.set(at[0]!, at[1]!, at[2]!).applyMatrix4(parent.matrixWorld);
  }

  hide(): void { this.body.visible = this.ring.visible = false; }

  paint(palette: Palette): void {
    this.lines.paint(palette.accent);
    (this.fill.material as MeshBasicMaterial).color.copy(palette.accent);
  }
}

// Of a symmetric matrix, by Jacobi's rotations.
export function eigen(matrix: number[]): { values: number[]; vectors: Vector3[] } {
  const a = new Matrix4().setFromMatrix3(new Matrix3().fromArray(matrix));
  const v = new Matrix4();
  for (let sweep = 0; sweep < 12; ++sweep) {
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]] as const) {
      const apq = a.elements[4 * q + p]!;
      if (Math.abs(apq) < 1e-20) continue;
      const theta = 0.5 * Math.atan2(2 * apq, a.elements[5 * q]! - a.elements[5 * p]!);
      const turn = new Matrix4();
      turn.elements[5 * p] = turn.elements[5 * q] = Math.cos(theta);
      turn.elements[4 * q + p] = Math.sin(theta);
      turn.elements[4 * p + q] = -Math.sin(theta);
      a.multiply(turn).premultiply(turn.clone().transpose());
      v.multiply(turn);
    }
  }
  const values = [0, 1, 2].map((i) => a.elements[5 * i]!);
  const vectors = [0, 1, 2].map((i) => new Vector3().setFromMatrixColumn(v, i));
  return { values, vectors };
}
