// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The axes of the map as they lie in the picture.
import { Quaternion, Vector3 } from "three";

import type { View } from "../scene/view";
import { make } from "./dom";

const SIZE_PX = 72;
const REACH_PX = 24;
const PAUSE_MS = 60;  // a picture of the map is not to wait for it
const AXES = [["x", new Vector3(1, 0, 0)], ["y", new Vector3(0, 1, 0)], ["z", new Vector3(0, 0, 1)]] as const;

export class Gizmo {
  readonly element = make("canvas", {
    class: "gizmo", role: "img", "aria-label": "axes of the map",
    title: "x, y, z: the axes of the map, which coordinates are told in. Up is estimated from how the cameras were held; north is not known.",
  });
  private drawn = "";
  private drawn_ms = 0;
  private style: { font: string; colours: Map<string, string> } | undefined;  // of the theme

  constructor(private readonly view: View) {
    const ratio = Math.min(2, window.devicePixelRatio);
    this.element.width = this.element.height = SIZE_PX * ratio;
    this.element.getContext("2d")!.scale(ratio, ratio);
  }

  redraw(): void {
    this.drawn = "";
    this.style = undefined;
  }

  draw(): void {
    const now_ms = performance.now();
    if (now_ms - this.drawn_ms < PAUSE_MS) return;
    this.drawn_ms = now_ms;
    const { stage, frames } = this.view;
    const frame = frames.all.get("map");
    this.element.hidden = frame === undefined;
    if (!frame) return;
    const turned = stage.camera.quaternion.clone().invert();
    const look = [...turned.toArray(), ...frame.turned.toArray()].map((value) => value.toFixed(3)).join();
    if (look === this.drawn) return;
    this.drawn = look;
    const context = this.element.getContext("2d")!;
    const { font, colours } = (this.style ??= this.readStyle());
    context.clearRect(0, 0, SIZE_PX, SIZE_PX);
    context.font = font;
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (const { name, x, y, near } of this.ends(turned, frame.turned)) {
      const middle = SIZE_PX / 2;
      context.globalAlpha = near ? 1 : 0.55;
      context.strokeStyle = context.fillStyle = colours.get(name)!;
      context.lineWidth = 2;
      context.beginPath();
      context.moveTo(middle, middle);
      context.lineTo(middle + REACH_PX * x, middle + REACH_PX * y);
      context.stroke();
      context.globalAlpha = 1;
      context.fillText(name, middle + (REACH_PX + 7) * x, middle + (REACH_PX + 7) * y);
    }
  }

  private readStyle(): { font: string; colours: Map<string, string> } {
    const style = getComputedStyle(this.element);
    return { font: `600 11px ${style.fontFamily}`, colours: new Map(AXES.map(([name]) => [name, style.getPropertyValue(`--axis-${name}`)])) };
  }

  // Farthest first.
  private ends(viewer: Quaternion, map: Quaternion): { name: string; x: number; y: number; near: boolean }[] {
    const seen = AXES.map(([name, axis]) => ({ name, at: axis.clone().applyQuaternion(map).applyQuaternion(viewer) }));
    return seen.sort((a, b) => a.at.z - b.at.z).map(({ name, at }) => ({ name, x: at.x, y: -at.y, near: at.z >= 0 }));
  }
}
