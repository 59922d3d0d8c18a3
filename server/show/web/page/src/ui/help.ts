// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The sheet of keys and colours.
import { button, make } from "./dom";

const KEYS: [keys: string[], what: string][] = [
  [["F"], "show everything"],
  [["T"], "from above, and back"],
  [["P"], "from the side, in perspective"],
  [["1", "9"], "follow a camera; again: let go"],
  [["M"], "measure from what is picked; or click with Shift"],
  [["Space"], "play, pause"],
  [["L"], "back to now"],
  [["S"], "save the picture"],
  [["?"], "this sheet"],
  [["Esc"], "let go, close"],
];
const HANDS: [string, string][] = [
  ["Drag", "turn; with the right button, or two fingers: shift"],
  ["Wheel, pinch", "nearer, farther"],
  ["Click", "what a point, camera or object is, and its life"],
  ["Time line", "drag to look back, wheel to zoom, double click for all"],
];
const COLOURS: [kind: string, what: string][] = [
  ["static", "point that stands still, proven"],
  ["trial", "point on trial: poses do not rest on it yet"],
  ["moving", "what moves: points, boxes, arrows of a second"],
  ["lost", "camera without a pose, and why on its card"],
  ["relative", "camera held by what moves alone"],
  ["gone", "camera that left or sends no images"],
];

export class Help {
  readonly element: HTMLDialogElement;

  constructor() {
    const close = button("close", "Close (Esc)", () => this.element.close());
    this.element = make("dialog", { class: "help", "aria-label": "keys and colours" },
      make("div", { class: "head" }, make("h2", {}, "Keys and colours"), close),
      make("dl", {}, ...KEYS.flatMap(([keys, what]) => [make("dt", {}, ...keys.flatMap((key, i) => (i === 0 ? [make("kbd", {}, key)] : [" to ", make("kbd", {}, key)]))), make("dd", {}, what)])),
      make("dl", {}, ...HANDS.flatMap(([how, what]) => [make("dt", {}, how), make("dd", {}, what)])),
      make("ul", {}, ...COLOURS.map(([kind, what]) => make("li", { class: kind }, what))),
      make("p", {}, "Each camera has a colour of its own, by the order of the names: its card, frustum, way and lane have it. Dashed lines join cameras that share points. Diamonds on a way: lost, found, maps joined, loop closed."),
      make("p", {}, "Up is estimated from how the cameras were held; north is not known. Lengths are metres where the scale is known (a tag, a rig or a baseline tells it), else units of the map."),
      make("a", { href: "licences.txt", target: "_blank" }, "What this page is made of"));
    this.element.addEventListener("click", (event) => { if (event.target === this.element) this.element.close(); });
  }

  flip(): void {
    if (this.element.open) this.element.close();
    else this.element.showModal();
  }
}
