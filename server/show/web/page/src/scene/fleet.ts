// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// All cameras of the run: their marks, the colour of each, what joins them, and where something happened to them.
import { Vector3 } from "three";

import type { Chronicle } from "../data/chronicle";
import type { RunEvent, RunState } from "../data/types";
import { CameraMark } from "./cameras";
import type { Frames } from "./frames";
import { Happened } from "./happened";
import type { Labels } from "./labels";
import { CAMERA_COLOURS, type Palette } from "./palette";
import { Links } from "./surroundings";

export class Fleet {
  readonly marks = new Map<string, CameraMark>();
  readonly links = new Links();
  readonly happened = new Happened();
  private readonly names = new Set<string>();  // of all cameras of the run so far
  private size = 1;                            // of a camera, in the picture

  constructor(private readonly labels: Labels, private readonly frames: Frames, private palette: Palette) {}

  clear(): void {
    for (const mark of this.marks.values()) this.remove(mark);
    this.names.clear();
    this.links.show([], this.palette, 1);
    this.happened.show([], 0, this.marks, this.palette, 1);
  }

  of(name: string): CameraMark {
    let mark = this.marks.get(name);
    if (!mark) {
      this.marks.set(name, (mark = new CameraMark(name, this.labels)));
      this.names.add(name);
      this.scale(this.size);
      this.paint(this.palette);
    }
    return mark;
  }

  takeState(state: RunState, chronicle: Chronicle): void {
    for (const agent of state.agents) this.of(agent.name).takeState(agent, chronicle.standing(agent, state));
    for (const [name, mark] of this.marks) if (!state.agents.some((agent) => agent.name === name)) this.remove(mark);
    this.paint(this.palette);
  }

  // As large in the picture, whatever the unit of their map.
  scale(size: number): void {
    this.size = size;
    for (const mark of this.marks.values()) mark.scale(size / (this.frames.all.get(mark.frame)?.scale ?? 1));
  }

  paint(palette: Palette): void {
    this.palette = palette;
    for (const [name, mark] of this.marks) mark.paint(palette.cameras[this.colourIndex(name)]!, palette);
  }

  // Each has its own, by the order of the names.
  colourIndex(name: string): number {
    const order = [...this.names].sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
    return Math.max(0, order.indexOf(name)) % CAMERA_COLOURS;
  }

  drawLinks(state: RunState | undefined): void {
    const links = (state?.links ?? []).flatMap(([a, b, shared]) => {
      const [from, to] = [a, b].map((name) => this.placeOf(name));
      return from && to ? [{ from, to, shared }] : [];
    });
    this.links.show(links, this.palette, this.size);
  }

  drawHappened(events: readonly RunEvent[], t_s: number): void { this.happened.show(events, t_s, this.marks, this.palette, this.size); }

  // In the picture.
  private placeOf(name: string): Vector3 | undefined {
    const mark = this.marks.get(name);
    return mark?.pose && mark.body.parent ? new Vector3().setFromMatrixPosition(mark.body.matrixWorld) : undefined;
  }

  private remove(mark: CameraMark): void {
    this.labels.remove(mark.label);
    mark.body.removeFromParent();
    mark.trail.object.removeFromParent();
    mark.keyFrames.object.removeFromParent();
    this.marks.delete(mark.name);
  }
}
