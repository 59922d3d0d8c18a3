// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What is picked: its figures, and its life as the server tells it.
import { fetchLife, type Life } from "../data/explain";
import { button, make, setText } from "./dom";

export interface Shown {
  title: string;
  about: string;
  figures: [name: string, value: string][];
  // What the server is asked for; undefined: nothing to ask.
  ask: { kind: "point" | "track" | "camera"; id: string } | undefined;
}

export class Inspector {
  readonly element: HTMLElement;
  onClose: () => void = () => {};
  onLife: (life: Life) => void = () => {};
  onMeasure: () => void = () => {};
  onTime: ((t_s: number) => void) | undefined;
  private readonly title = make("h2");
  private readonly about = make("p", { class: "about" });
  private readonly figures = make("dl", { class: "facts" });
  private readonly life = make("section", { class: "life" });
  private readonly ruler = button("ruler", "Measure: then click the other end (M)", () => this.onMeasure());
  private asked = "";
  private abort = new AbortController();

  constructor(private readonly token: string | null) {
    const close = button("close", "Close (Esc)", () => this.onClose());
    this.element = make("aside", { class: "inspector", hidden: "", "aria-label": "what is picked" },
      make("div", { class: "head" }, this.title, this.ruler, close), this.about, this.figures, this.life);
  }

  show(shown: Shown | undefined, served: boolean, measures: boolean): void {
    this.element.hidden = shown === undefined;
    if (!shown) {
      this.asked = "";
      this.abort.abort();
      return;
    }
    setText(this.title, shown.title);
    this.ruler.setAttribute("aria-pressed", String(measures));
    setText(this.about, measures ? "Click the other end of the length." : shown.about);
    const look = JSON.stringify(shown.figures);
    if (this.figures.dataset["look"] !== look) {
      this.figures.dataset["look"] = look;
      this.figures.replaceChildren(...shown.figures.map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, value))));
    }
    const ask = shown.ask && served ? `${shown.ask.kind} ${shown.ask.id}` : "";
    if (ask === this.asked) return;
    this.asked = ask;
    this.life.replaceChildren();
    if (ask !== "") void this.ask(shown.ask!);
  }

  private async ask({ kind, id }: { kind: string; id: string }): Promise<void> {
    this.abort.abort();
    this.abort = new AbortController();
    const { signal } = this.abort;
    this.life.replaceChildren(make("h3", {}, "Life"), make("p", { class: "wait" }, "asking the server"));
    try {
      const life = await fetchLife(kind, id, this.token, signal);
      if (signal.aborted) return;
      this.showLife(life);
      this.onLife(life);
    } catch (error) {
      if (signal.aborted) return;
      this.life.replaceChildren(make("h3", {}, "Life"), make("p", { class: "wait" }, error instanceof Error ? error.message : String(error)));
    }
  }

  private showLife(life: Life): void {
    const rows = life.entries.map(({ t_s, text }) => {
      const time = this.onTime
        ? make("button", { type: "button", title: "Show this instant", onclick: () => this.onTime?.(t_s) }, `${t_s.toFixed(1)} s`)
        : make("span", {}, `${t_s.toFixed(1)} s`);
      return make("li", {}, time, make("p", {}, text));
    });
    const notes = life.notes.map((note) => make("p", { class: "note" }, note));
    this.life.replaceChildren(make("h3", {}, "Life"), make("ol", {}, ...rows), ...notes);
  }
}
