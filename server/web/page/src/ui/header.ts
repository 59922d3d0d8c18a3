// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The top line: how the connection is, what the map holds, and how it is looked at.
import type { Live } from "../data/live";
import type { RunState } from "../data/types";
import type { Player } from "../player";
import { button, count, digits, make, plural, seconds, setText } from "./dom";

export interface HeaderActions {
  fit(): void;
  top(): void;
  theme(): void;
  layers(): void;
  open(): void;
  retry(): void;
}

export class Header {
  readonly element: HTMLElement;
  private readonly pill: HTMLElement;
  private readonly figures = make("dl", { class: "figures" });
  private readonly values = new Map<string, HTMLElement>();
  private readonly run = make("span", { class: "run" });
  private readonly bar = make("div", { class: "bar", role: "alert", hidden: "" });

  constructor(actions: HeaderActions) {
    this.pill = make("span", { class: "pill", role: "status" });
    const tools = make("nav", { class: "tools", "aria-label": "view" },
      button("fit", "Show everything (F)", actions.fit),
      button("top", "From above (T)", actions.top),
      button("layers", "What is shown, and in which colours", actions.layers),
      button("open", "Open a recording (.mcap)", actions.open),
      button("theme", "Light or dark", actions.theme));
    const brand = make("h1", {}, "CoSLAM");
    this.element = make("header", {}, brand, this.pill, this.run, this.figures, tools, this.bar);
    this.bar.addEventListener("click", () => actions.retry());
  }

  showState(state: RunState | undefined): void {
    setText(this.run, state ? `run ${state.run.slice(0, 8)}` : "");
    if (!state) return;
    const { server } = state;
    this.figure("points", count(server.points), "points");
    this.figure("moving", count(server.moving_points), "moving", server.moving_points > 0 ? "moving" : "");
    this.figure("objects", count(server.objects), server.objects === 1 ? "object" : "objects", server.objects > 0 ? "moving" : "");
    this.figure("maps", count(server.maps), server.maps === 1 ? "map" : "maps", server.maps > 1 ? "warn" : "");
    this.figure("keys", count(server.key_frames), "key frames");
    this.figure("set", digits(server.ms_per_set, 1), "ms a set");
    this.figure("memory", count(server.memory_mib), "MiB");
    if (server.left_out > 0) this.figure("left", count(server.left_out), "sets left out", "warn");
    this.figure("scale", state.scale_known ? "metres" : "no scale", "", state.scale_known ? "" : "warn");
  }

  showRecording(name: string): void {
    this.pill.className = "pill recorded";
    setText(this.pill, name);
    this.bar.hidden = true;
  }

  showLink(live: Live, player: Player, lag_s: number | undefined, finishing: boolean): void {
    const now = performance.now();
    const { link } = live;
    const [kind, text] = ((): [string, string] => {
      if (link.kind === "connecting") return ["waiting", live.heard_ms === 0 ? "connecting" : "connecting again"];
      if (link.kind === "silent") return ["waiting", `silent for ${digits((now - link.since_ms) / 1000, 0)} s`];
      if (link.kind === "lost") return ["lost", "no connection"];
      if (finishing && player.mode === "live") return ["waiting", "over, being adjusted"];
      return player.mode === "live" ? ["live", lag_s === undefined ? "live" : `live, ${seconds(lag_s)} behind`] : ["past", "looking back"];
    })();
    this.pill.className = `pill ${kind}`;
    setText(this.pill, text);
    this.bar.hidden = link.kind !== "lost";
    if (link.kind !== "lost") return;
    const left_s = Math.max(0, Math.ceil((link.again_ms - now) / 1000));
    const old = live.heard_ms === 0 ? "" : ` What you see is ${plural(Math.round((now - live.heard_ms) / 1000), "second")} old.`;
    setText(this.bar, `The server does not answer.${old} Next try in ${left_s} s; click to try now.`);
  }

  private figure(key: string, value: string, unit: string, kind = ""): void {
    let element = this.values.get(key);
    if (!element) {
      element = make("div", { "data-key": key }, make("dd"), make("dt"));
      this.values.set(key, element);
      this.figures.append(element);
    }
    element.className = kind;
    setText(element.firstElementChild as HTMLElement, value);
    setText(element.lastElementChild as HTMLElement, unit);
  }
}
