// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The axes of the map as they lie in the picture.
import { Quaternion, Vector3 } from "three";

import type { View } from "../scene/view";
import { make } from "./dom";

const SIZE_PX = 72;
const REACH_PX = 24;
const AXES = [["x", new Vector3(1, 0, 0)], ["y", new Vector3(0, 1, 0)], ["z", new Vector3(0, 0, 1)]] as const;

export class Gizmo {
  readonly element = make("canvas", {
    class: "gizmo", role: "img", "aria-label": "axes of the map",
    title: "x, y, z: the axes of the map, which coordinates are told in. Up is estimated from how the cameras were held; north is not known.",
  });
  private drawn = "";

  constructor(private readonly view: View) {
    const ratio = Math.min(2, window.devicePixelRatio);
    this.element.width = this.element.height = SIZE_PX * ratio;
    this.element.getContext("2d")!.scale(ratio, ratio);
  }

  redraw(): void { this.drawn = ""; }

  draw(): void {
    const { stage, frames } = this.view;
    const frame = frames.all.get("map");
    this.element.hidden = frame === undefined;
    if (!frame) return;
    const turned = stage.camera.quaternion.clone().invert();
    const look = [...turned.toArray(), ...frame.turned.toArray()].map((value) => value.toFixed(3)).join();
    if (look === this.drawn) return;
    this.drawn = look;
    const context = this.element.getContext("2d")!;
    const style = getComputedStyle(this.element);
    context.clearRect(0, 0, SIZE_PX, SIZE_PX);
    context.font = `600 11px ${style.fontFamily}`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (const { name, x, y, near } of this.ends(turned, frame.turned)) {
      const middle = SIZE_PX / 2;
      context.globalAlpha = near ? 1 : 0.55;
      context.strokeStyle = context.fillStyle = style.getPropertyValue(`--axis-${name}`);
      context.lineWidth = 2;
      context.beginPath();
      context.moveTo(middle, middle);
      context.lineTo(middle + REACH_PX * x, middle + REACH_PX * y);
      context.stroke();
      context.globalAlpha = 1;
      context.fillText(name, middle + (REACH_PX + 7) * x, middle + (REACH_PX + 7) * y);
    }
  }

  // Farthest first.
  private ends(viewer: Quaternion, map: Quaternion): { name: string; x: number; y: number; near: boolean }[] {
    const seen = AXES.map(([name, axis]) => ({ name, at: axis.clone().applyQuaternion(map).applyQuaternion(viewer) }));
    return seen.sort((a, b) => a.at.z - b.at.z).map(({ name, at }) => ({ name, x: at.x, y: -at.y, near: at.z >= 0 }));
  }
}
