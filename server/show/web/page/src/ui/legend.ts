// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the colours of the points mean: names, or a bar with numbers; and how large a square of the grid is.
import { Color } from "three";

import { rampColour, type ColourBy } from "../scene/point_shader";
import type { View } from "../scene/view";
import { gridText, length, make, setText } from "./dom";

const STEPS = 12;

export class Legend {
  readonly element = make("div", { class: "legend" });
  private readonly names = make("ul", {}, ...["static", "on trial", "moving"].map((text) => make("li", { class: text.replace(" ", "-") }, text)));
  private readonly bar = make("div", { class: "ramp" });
  private readonly low = make("span");
  private readonly what = make("b");
  private readonly high = make("span");
  private readonly grid = make("p");
  private ramp = "";

  constructor(private readonly view: View) {
    const scale = make("div", { class: "scale" }, make("p", {}, this.low, this.what, this.high), this.bar);
    this.element.append(this.names, scale, this.grid);
  }

  show(): void {
    const { points, palette, floor, unit, stage } = this.view;
    const { by } = points;
    this.element.dataset["by"] = by;
    const ramp = by === "state" ? "" : rampOf(palette.ramp);
    if (ramp !== this.ramp) this.bar.style.background = `linear-gradient(to right, ${ramp})`;
    this.ramp = ramp;
    const [what, low, high] = this.ends(by, ...points.scaleOf(by), unit);
    setText(this.what, what);
    setText(this.low, low);
    setText(this.high, high);
    const grid = floor.cell > 0 ? gridText(floor.cell, unit) : "";
    const speed = new URLSearchParams(location.search).has("stats") ? `  ${stage.frames_per_s.toFixed(0)} pictures/s at ${stage.pixelRatio().toFixed(2)}` : "";
    setText(this.grid, grid + speed);
  }

  private ends(by: ColourBy, low: number, high: number, unit: string): [what: string, low: string, high: string] {
    if (by === "certainty") return ["deviation", length(low, unit), length(high, unit)];
    if (by === "height") return ["height", length(low, unit), length(high, unit)];
    return by === "views" ? ["views", "0", `${high} and more`] : ["", "", ""];
  }
}

function rampOf(ramp: readonly [Color, Color, Color]): string {
  return Array.from({ length: STEPS + 1 }, (_, i) => `#${rampColour(ramp, i / STEPS, new Color()).getHexString()}`).join(", ");
}
