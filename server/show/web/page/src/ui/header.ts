// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The top line: how the connection is, what the map holds, and how it is looked at.
import type { Chronicle } from "../data/chronicle";
import type { MapFigure } from "../data/figures";
import { isOfNow, type Live } from "../data/live";
import { worstPath } from "../data/quality";
import type { RunState } from "../data/types";
import type { Player } from "../player";
import { button, count, digits, Figure, make, seconds, setText } from "./dom";
import { Spark, SPARK_S } from "./spark";

export interface HeaderActions {
  fit(): void;
  top(): void;
  theme(): void;
  layers(): void;
  help(): void;
  // Tells what can be done about an unknown scale.
  scale(): void;
}

export const NO_SCALE = "Lengths are in units of the map: images alone do not tell how large things are. A printed tag, a rig of cameras or a known baseline does: see `scale` in docs/configuration.md.";

export class Header {
  readonly element: HTMLElement;
  private readonly pill: HTMLElement;
  private readonly figures = make("dl", { class: "figures" });
  private readonly values = new Map<string, Figure>();
  private readonly sparks = new Map<string, Spark>();
  private readonly run = make("span", { class: "run" });
  private readonly scale: HTMLButtonElement;

  constructor(actions: HeaderActions) {
    this.pill = make("span", { class: "pill", role: "status" });
    this.scale = make("button", { type: "button", class: "scale", title: NO_SCALE, hidden: "", onclick: actions.scale }, "no scale");
    const tools = make("nav", { class: "tools", "aria-label": "view" },
      button("fit", "Show everything (F)", actions.fit),
      button("top", "From above, and back (T)", actions.top),
      button("layers", "What is shown, and in which colours", actions.layers),
      button("theme", "Light or dark", actions.theme),
      button("help", "Keys and colours (?)", actions.help));
    this.element = make("header", {}, make("h1", {}, "CoSLAM"), this.pill, this.run, this.figures, this.scale, tools);
  }

  showState(state: RunState | undefined, chronicle: Chronicle, t_s: number): void {
    setText(this.run, state && state.run !== "" ? `run ${state.run.slice(0, 8)}` : "");
    this.scale.hidden = state === undefined || state.scale_known || state.server.points === 0;
    if (!state) return;
    const { server } = state;
    this.figure("points", count(server.points), "points");
    this.plot("points", chronicle, t_s);
    this.figure("moving", count(server.moving_points), "moving", server.moving_points > 0 ? "moving" : "");
    this.figure("objects", server.objects > 0 ? count(server.objects) : null, server.objects === 1 ? "object" : "objects", server.objects > 0 ? "moving" : "");
    this.figure("maps", count(server.maps), server.maps === 1 ? "map" : "maps", server.maps > 1 ? "warn" : "");
    const worst = worstPath(state);
    this.figure("quality", worst, "map", worst === "poor" ? "warn" : "");
    this.figure("keys", server.key_frames === null ? null : count(server.key_frames), "key frames");
    this.figure("set", digits(server.ms_per_set, 1), "ms a set");
    this.plot("set", chronicle, t_s);
    this.figure("memory", server.memory_mib === null ? null : count(server.memory_mib), "MiB");
    this.figure("left", server.left_out ? count(server.left_out) : null, "sets left out", "warn");
  }

  redraw(): void { for (const spark of this.sparks.values()) spark.redraw(); }

  showRecording(name: string): void {
    this.pill.className = "pill recorded";
    setText(this.pill, name);
  }

  showLink(live: Live, player: Player, lag_s: number | undefined, finishing: boolean): void {
    const [kind, text] = pillOf(live, player, lag_s, finishing);
    this.pill.className = `pill ${kind}`;
    setText(this.pill, text);
  }

  // null: not known, and not shown.
  private figure(key: string, value: string | null, unit: string, kind = ""): void {
    let figure = this.values.get(key);
    if (!figure) {
      this.values.set(key, (figure = new Figure(key)));
      this.figures.append(figure.element);
    }
    figure.element.hidden = value === null;
    if (value !== null) figure.show(value, unit, kind);
  }

  private plot(key: "points" | "set", chronicle: Chronicle, t_s: number): void {
    let spark = this.sparks.get(key);
    if (!spark) {
      this.sparks.set(key, (spark = new Spark()));
      const { element } = this.values.get(key)!;
      element.append(spark.element);
      element.title = `The last ${SPARK_S} seconds`;
    }
    const name: MapFigure = key === "set" ? "ms a set" : key;
    spark.show(chronicle.figures.ofMap(name, t_s - SPARK_S, t_s), t_s);
  }
}

function pillOf(live: Live, player: Player, lag_s: number | undefined, finishing: boolean): [kind: string, text: string] {
  const { link } = live;
  if (link.kind === "connecting") return ["waiting", live.heard_ms === 0 ? "connecting" : "connecting again"];
  if (link.kind === "silent") return ["waiting", `silent for ${digits((performance.now() - link.since_ms) / 1000, 0)} s`];
  if (link.kind === "lost") return ["lost", "no connection"];
  if (link.kind === "refused") return ["waiting", "no token"];
  if (player.mode !== "live") return ["past", "looking back"];
  if (link.kind === "over") return ["recorded", "over"];
  if (finishing) return ["waiting", "over, being adjusted"];
  const pace = live.pace();
  if (pace !== undefined && !isOfNow(pace)) return ["live", `live, ×${digits(pace, 1)}`];
  return ["live", lag_s === undefined || !live.lagHolds() ? "live" : `live, ${seconds(lag_s)} behind`];
}
