// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A small plot: a figure over the last minute, or since it is known.
import type { Curve } from "../data/figures";
import { make } from "./dom";

export const SPARK_S = 60;
const PAD_PX = 2;
const OFTEN_HZ = 2;
const LEAST_S = 5;
const GAP_S = 3;  // nothing for so long: the line is broken

export class Spark {
  readonly element = make("canvas", { class: "spark", "aria-hidden": "true" });
  private drawn = "";

  redraw(): void { this.drawn = ""; }

  // From zero to the most.
  show({ t_s, values }: Curve, to_s: number): void {
    const { element } = this;
    const look = [Math.floor(OFTEN_HZ * to_s), t_s.length >> 2, t_s[0]].join();
    if (look === this.drawn) return;
    const [width, height] = [element.clientWidth, element.clientHeight];
    if (width === 0) return;
    this.drawn = look;
    const ratio = Math.min(2, window.devicePixelRatio);
    element.width = width * ratio;
    element.height = height * ratio;
    const context = element.getContext("2d")!;
    context.scale(ratio, ratio);
    const most = Math.max(1e-9, ...values);
    const span_s = Math.min(SPARK_S, Math.max(LEAST_S, to_s - (t_s[0] ?? to_s)));
    const x = (at_s: number) => width - PAD_PX - ((to_s - at_s) / span_s) * (width - 2 * PAD_PX);
    const y = (value: number) => height - PAD_PX - (Math.max(0, value) / most) * (height - 2 * PAD_PX);
    const style = getComputedStyle(element);
    context.fillStyle = style.getPropertyValue("--line");
    context.fillRect(0, height - 1, width, 1);
    context.strokeStyle = style.color;
    context.lineWidth = 1.4;
    context.lineJoin = "round";
    context.beginPath();
    t_s.forEach((at_s, i) => {
      if (i === 0 || at_s - t_s[i - 1]! > GAP_S) context.moveTo(x(at_s), y(values[i]!));
      else context.lineTo(x(at_s), y(values[i]!));
    });
    context.stroke();
  }
}
