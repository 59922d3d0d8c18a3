// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The image plane of a camera: its tracks as dots, by what they follow.
import type { Tracks } from "../data/types";
import { make } from "./dom";

const STATES = ["none", "static", "moving", "relative"];  // names of colours, by state
const NEAR_PX = 8;

export class Plane {
  readonly element = make("canvas", { class: "plane", title: "what the camera follows" });
  onPick: (track: number) => void = () => {};
  private tracks: Tracks | undefined;

  constructor() {
    this.element.addEventListener("click", ({ offsetX, offsetY }) => {
      const id = this.nearest(offsetX, offsetY);
      if (id !== undefined) this.onPick(id);
    });
  }

  show(tracks: Tracks | undefined): void {
    if (tracks === this.tracks) return;
    this.tracks = tracks;
    this.draw();
  }

  draw(): void {
    const { element, tracks } = this;
    const ratio = Math.min(2, window.devicePixelRatio);
    const width = element.clientWidth;
    if (width === 0) return;
    const height = Math.round(width * (tracks ? tracks.height / tracks.width : 0.64));
    element.style.height = `${height}px`;
    element.width = width * ratio;
    element.height = height * ratio;
    const context = element.getContext("2d")!;
    context.scale(ratio, ratio);
    const style = getComputedStyle(element);
    const colours = STATES.map((name) => style.getPropertyValue(`--${name}`));
    if (!tracks) {
      context.fillStyle = style.getPropertyValue("--faint");
      context.textAlign = "center";
      context.fillText("no tracks yet", width / 2, height / 2);
      return;
    }
    const scale = width / tracks.width;
    // What is rare is drawn last.
    for (const state of [0, 1, 3, 2]) {
      context.fillStyle = colours[state]!;
      const size = state === 2 ? 3.4 : state === 0 ? 2 : 2.6;
      for (const [, u, v, own] of tracks.tracks) {
        if (own === state) context.fillRect(u * scale - size / 2, v * scale - size / 2, size, size);
      }
    }
  }

  private nearest(x: number, y: number): number | undefined {
    if (!this.tracks) return undefined;
    const scale = this.element.clientWidth / this.tracks.width;
    let best: number | undefined;
    let least = NEAR_PX;
    for (const [id, u, v] of this.tracks.tracks) {
      const far = Math.hypot(u * scale - x, v * scale - y);
      if (far < least) [best, least] = [id, far];
    }
    return best;
  }
}
