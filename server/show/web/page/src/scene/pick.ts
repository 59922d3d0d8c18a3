// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What lies under a place on the screen.
import { Matrix4, Vector3 } from "three";

import type { View } from "./view";

export type Picked =
  | { kind: "point"; id: number }
  | { kind: "moving"; id: number }
  | { kind: "camera"; name: string }
  | { kind: "object"; id: number }
  | { kind: "track"; agent: string; id: number };

const NEAR_PX = 9;
const FINGER_PX = 20;

export function pick(view: View, x_px: number, y_px: number, finger: boolean): Picked | undefined {
  const within = finger ? FINGER_PX : NEAR_PX;
  const { width, height } = view.stage;
  const clip = view.clip();
  const distance = (place: Vector3) => {
    const p = place.clone().applyMatrix4(clip);
    return p.z > 1 ? Infinity : Math.hypot(((p.x + 1) / 2) * width - x_px, ((1 - p.y) / 2) * height - y_px);
  };
  for (const [name, mark] of view.cameras) {
    if (mark.body.visible && distance(new Vector3().setFromMatrixPosition(mark.body.matrixWorld)) < 1.5 * within) return { kind: "camera", name };
  }
  const moving = nearestMoving(view, distance, within);
  if (moving !== undefined) return { kind: "moving", id: moving };
  const index = view.points.pick(clip, x_px, y_px, width, height, within);
  if (index >= 0) return { kind: "point", id: view.points.figures(index).id };
  for (const [id, mark] of view.objects.all) {
    const centre = new Vector3().setFromMatrixPosition(new Matrix4().multiplyMatrices(mark.body.parent!.matrixWorld, mark.box.matrix));
    if (distance(centre) < 3 * within) return { kind: "object", id };
  }
  return undefined;
}

function nearestMoving(view: View, distance: (place: Vector3) => number, within: number): number | undefined {
  const { now, root } = view.moving;
  if (!now || !root.visible || !root.parent) return undefined;
  let best: number | undefined;
  let least = within;
  for (let i = 0; i < now.count; ++i) {
    const far = distance(new Vector3().fromArray(now.xyz, 3 * i).applyMatrix4(root.parent.matrixWorld));
    if (far < least) [best, least] = [now.id[i], far];
  }
  return best;
}
