// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Where cameras were when they were lost or found, when maps were joined and loops closed: small diamonds on their ways.
import { Color, Vector3 } from "three";

import type { RunEvent } from "../data/types";
import type { CameraMark } from "./cameras";
import { Strokes } from "./lines";
import type { Palette } from "./palette";

const SIZE = 0.16;  // of a camera
const MOST = 200;
const CORNERS = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]].map(([x, y, z]) => new Vector3(x, y, z));
const EDGES = [[0, 2], [0, 3], [0, 4], [0, 5], [1, 2], [1, 3], [1, 4], [1, 5], [2, 4], [2, 5], [3, 4], [3, 5]] as const;

export class Happened {
  readonly strokes = new Strokes(1.5);
  any = false;

  show(events: readonly RunEvent[], t_s: number, cameras: ReadonlyMap<string, CameraMark>, palette: Palette, size: number): void {
    const colours: Record<string, Color> = { lost: palette.lost, found: palette.relative, maps_joined: palette.accent, loop: palette.accent };
    const ends: number[] = [];
    const shades: number[] = [];
    for (const event of events.filter(({ kind, t_s: at_s }) => kind in colours && at_s <= t_s).slice(-MOST)) {
      for (const mark of event.agents.map((name) => cameras.get(name))) {
        const place = mark?.body.parent?.visible ? mark.placeAt(event.t_s)?.applyMatrix4(mark.body.parent.matrixWorld) : undefined;
        if (!place) continue;
        for (const edge of EDGES) for (const corner of edge) ends.push(...CORNERS[corner]!.clone().multiplyScalar(SIZE * size).add(place).toArray());
        for (let i = 0; i < 2 * EDGES.length; ++i) shades.push(...colours[event.kind]!.toArray());
      }
    }
    this.any = ends.length > 0;
    this.strokes.set(ends, shades);
  }
}
