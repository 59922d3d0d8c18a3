// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What is drawn, in which colours, and what is made a file of.
import { COLOUR_BY, type ColourBy } from "../scene/point_shader";
import type { View } from "../scene/view";
import { make } from "./dom";

const NAMES: Record<ColourBy, string> = { state: "State", certainty: "Certainty", height: "Height", views: "Views" };

export class Layers {
  readonly element: HTMLElement;

  constructor(private readonly view: View, actions: { picture(): void; map(): void; open(): void }) {
    const by = make("div", { class: "choice", role: "radiogroup", "aria-label": "colour of points" }, ...COLOUR_BY.map((each) => this.choice(each)));
    const least = make("input", { type: "range", min: "0", max: "0.95", step: "0.05", value: "0", "aria-label": "hide uncertain points" });
    least.addEventListener("input", () => this.set("leastCertain", Number(least.value)));
    const size = make("input", { type: "range", min: "0.4", max: "3", step: "0.1", value: "1", "aria-label": "size of points" });
    size.addEventListener("input", () => { view.pointScale = Number(size.value); view.stage.invalidate(); });
    const all = view.shownLayers;
    this.element = make("div", { class: "layers", hidden: "" },
      make("h3", {}, "Points by"), by,
      make("label", {}, "Hide uncertain", least), make("label", {}, "Size", size),
      make("h3", {}, "Show"), ...Object.keys(all).map((name) => this.toggle(name as keyof typeof all)),
      make("h3", {}, "Files"), make("div", { class: "files" },
        make("button", { type: "button", title: "A PNG of what is shown (S)", onclick: actions.picture }, "Save picture"),
        make("button", { type: "button", title: "The proven points of the main map, as PLY", onclick: actions.map }, "Save map"),
        make("button", { type: "button", title: "A recorded run, .mcap; it can be dropped on the page too", onclick: actions.open }, "Open recording")));
  }

  flip(): void { this.element.hidden = !this.element.hidden; }

  private choice(by: ColourBy): HTMLElement {
    const input = make("input", { type: "radio", name: "colour-by", value: by });
    input.checked = by === "state";
    input.addEventListener("change", () => this.view.colourBy(by));
    return make("label", {}, input, make("span", {}, NAMES[by]));
  }

  private toggle(name: keyof View["shownLayers"]): HTMLElement {
    const input = make("input", { type: "checkbox" });
    input.checked = true;
    input.addEventListener("change", () => {
      this.view.shownLayers[name] = input.checked;
      this.view.stage.invalidate();
    });
    return make("label", { class: "toggle" }, input, name);
  }

  private set(uniform: string, value: number): void {
    this.view.points.material.uniforms[uniform]!.value = value;
    this.view.stage.invalidate();
  }
}
