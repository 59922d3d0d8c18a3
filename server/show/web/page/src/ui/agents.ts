// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A card for each camera: its state at a glance, figures and image plane when opened.
import { causeOf } from "../data/cause";
import type { Chronicle, Standing } from "../data/chronicle";
import { AGENT_FIGURES, type AgentFigure } from "../data/figures";
import { pathSentence } from "../data/quality";
import type { AgentState, RunState, Tracks } from "../data/types";
import { button, count, digits, Figure, make, seconds, setText } from "./dom";
import { Plane } from "./plane";
import { Spark, SPARK_S } from "./spark";
import { Thumbnail } from "./thumbnail";

export interface AgentActions {
  select(agent: string): void;
  follow(agent: string): void;
  through(agent: string): void;
  opened(agent: string, open: boolean): void;
  track(agent: string, track: number): void;
}

// What is shown of an agent at an instant.
export interface Shown { agent: AgentState; standing: Standing; lostFor_s: number | undefined; lagHolds: boolean }

const STATE_TEXT: Record<Standing, string> = {
  tracking: "tracking", relative: "by what moves", lost: "lost", none: "waiting", unheard: "no images", gone: "left", ended: "ended",
};
const PLOTS: Record<AgentFigure, string> = { tracks: "tracks", ms: "ms a frame", lag: "ms lag", kB: "kB/s up" };
const SAYS_WHY = new Set<Standing>(["lost", "relative", "none", "unheard"]);

const plotValue = (name: AgentFigure, { agent, lagHolds }: Shown): number | null =>
  ({ tracks: agent.tracks, ms: agent.frame_ms, lag: lagHolds && agent.lag_s !== null ? 1000 * agent.lag_s : null, kB: agent.kB_up_per_s })[name];

class Card {
  readonly element: HTMLElement;
  readonly plane = new Plane();
  private readonly thumbnail: Thumbnail;
  open = false;
  private readonly quality = make("span", { class: "quality", hidden: "" });
  private readonly state = make("span", { class: "state" });
  private readonly cause = make("b");
  private readonly said = make("span");
  private readonly why = make("p", { class: "why", hidden: "" }, this.cause, this.said);
  private readonly short = make("dl", { class: "short" });
  private readonly long = make("dl", { class: "long" });
  private readonly path = make("p", { class: "path", hidden: "" });
  private readonly plots = new Map(AGENT_FIGURES.map((name) => [name, { spark: new Spark(), value: make("b"), row: make("div", { class: "plot" }) }]));
  private readonly more: HTMLElement;
  private readonly follow: HTMLButtonElement;
  private readonly through: HTMLButtonElement;
  private readonly head: HTMLElement;
  private readonly values = new Map<string, Figure>();

  constructor(readonly name: string, actions: AgentActions, token: string | null) {
    this.thumbnail = new Thumbnail(name, token);
    this.head = make("button", { type: "button", class: "head", "aria-expanded": "false", onclick: () => this.toggle(actions) },
      make("i", { class: "swatch" }), make("b", {}, name), this.quality, this.state);
    this.follow = button("follow", `Follow ${name}`, () => actions.follow(name), "Follow");
    this.through = button("eye", `Look through ${name}`, () => actions.through(name), "Look through");
    const details = make("button", { type: "button", onclick: () => actions.select(name) }, "Life");
    const legend = make("p", { class: "key" }, ...["static", "moving", "uncertain", "unmapped"].map((text) => make("span", { class: text }, text)));
    const plots = make("div", { class: "plots", title: `The last ${SPARK_S} seconds` });
    for (const [name, { spark, value, row }] of this.plots) {
      row.append(make("p", {}, value, ` ${PLOTS[name]}`), spark.element);
      plots.append(row);
    }
    this.more = make("div", { class: "more", hidden: "" }, this.path, this.long, plots, this.thumbnail.element, this.plane.element, legend, make("div", { class: "buttons" }, this.follow, this.through, this.thumbnail.switch, details));
    this.element = make("article", { class: "agent", "data-agent": name }, this.head, this.why, this.short, this.more);
    this.plane.onPick = (track) => actions.track(name, track);
  }

  show(shown: Shown, colour: string, live: boolean): void {
    const { agent, standing, lostFor_s } = shown;
    this.thumbnail.allow(live && standing !== "gone" && standing !== "ended");
    this.element.dataset["state"] = standing;
    this.element.style.setProperty("--colour", colour);
    const text = STATE_TEXT[standing];
    setText(this.state, standing === "lost" && lostFor_s !== undefined ? `lost for ${seconds(lostFor_s)}` : text);
    this.showWhy(agent, standing);
    this.showPath(agent);
    this.figure(this.short, "rate", digits(agent.rate_hz, 1), "Hz", "Frames a second");
    this.figure(this.short, "frame", digits(agent.frame_ms, 1), "ms", "What the agent needs for a frame");
    const bytes = agent.kB_up_per_s === null ? null : `${digits(agent.kB_up_per_s, 0)} / ${digits(agent.kB_down_per_s, 0)}`;
    this.figure(this.short, "bytes", bytes, "kB/s ↑↓", "kB/s to the server and from it");
    const lag_s = shown.lagHolds ? agent.lag_s : null;
    const [lag, unit] = seconds(lag_s).split(" ") as [string, string];
    this.figure(this.short, "lag", lag_s === null ? null : lag, `${unit} lag`, "From the capture to the map, beyond the least", (lag_s ?? 0) > 0.5 ? "warn" : "");
    if (this.open) this.showLong(shown);
  }

  showTracks(tracks: Tracks | undefined): void { if (this.open) this.plane.show(tracks); }

  showPlots(chronicle: Chronicle, shown: Shown, t_s: number): void {
    if (!this.open) return;
    for (const [name, { spark, value, row }] of this.plots) {
      const now = plotValue(name, shown);
      row.hidden = now === null;
      if (now === null) continue;
      setText(value, digits(now, name === "ms" ? 1 : 0));
      spark.show(chronicle.figures.ofAgent(this.name, name, t_s - SPARK_S, t_s), t_s);
    }
  }

  redraw(): void {
    this.plane.draw();
    for (const { spark } of this.plots.values()) spark.redraw();
  }

  mark(selected: boolean, followed: boolean, through: boolean): void {
    this.element.classList.toggle("selected", selected);
    this.follow.setAttribute("aria-pressed", String(followed));
    this.through.setAttribute("aria-pressed", String(through));
  }

  toggle(actions: AgentActions): void {
    this.open = !this.open;
    this.more.hidden = !this.open;
    this.head.setAttribute("aria-expanded", String(this.open));
    if (!this.open) this.thumbnail.set(false);
    actions.opened(this.name, this.open);
    if (this.open) this.plane.draw();
  }

  end(): void { this.thumbnail.set(false); }

  // In its own terms first, then as the server says it.
  private showWhy(agent: AgentState, standing: Standing): void {
    const cause = standing === "lost" ? causeOf(agent) : "";
    this.why.hidden = !SAYS_WHY.has(standing) || (agent.why === "" && cause === "");
    setText(this.cause, cause);
    setText(this.said, agent.why);
  }

  // How good its path is: a word, and what it rests on.
  private showPath({ path, scale_known }: AgentState): void {
    this.quality.hidden = this.path.hidden = !path;
    if (!path) return;
    const said = pathSentence(path, scale_known === true);
    this.quality.dataset["quality"] = path.quality;
    this.quality.title = said;
    setText(this.quality, path.quality);
    setText(this.path, said);
  }

  private showLong({ agent }: Shown): void {
    const clock = agent.clock_offset_ms, { account } = agent;
    this.figure(this.long, "tracks", count(agent.tracks), "followed", "Tracks");
    this.figure(this.long, "bound", count(agent.bound), "on the map", "Tracks with a point of the map", agent.bound < 15 ? "warn" : "");
    this.figure(this.long, "loss", agent.lost_percent === null ? null : digits(agent.lost_percent, 1), "% lost", "Frames that the network lost", (agent.lost_percent ?? 0) > 2 ? "warn" : "");
    this.figure(this.long, "images", account ? count(account.captured) : null, "images", "That its source gave");
    this.figure(this.long, "posed", account ? digits(100 * account.tracked / Math.max(1, account.captured), 1) : null, "% tracked", agent.losses || "All of its images are tracked");
    this.figure(this.long, "clock", clock === null ? null : `${clock < 0 ? "−" : "+"}${digits(Math.abs(clock), 1)}`, "ms clock", "Its clock against that of the server");
    this.figure(this.long, "map", agent.map === 0 ? "none" : String(agent.map), "map", "The map that it is in");
  }

  // null: not known, and not shown.
  private figure(list: HTMLElement, key: string, value: string | null, unit: string, title: string, kind = ""): void {
    let figure = this.values.get(key);
    if (!figure) {
      this.values.set(key, (figure = new Figure(key, title)));
      list.append(figure.element);
    }
    figure.element.hidden = value === null;
    if (value !== null) figure.show(value, unit, kind);
  }
}

export class Agents {
  readonly element = make("section", { class: "agents", "aria-label": "cameras" });
  private readonly cards = new Map<string, Card>();

  // token: of the server, for what is asked of it.
  constructor(private readonly actions: AgentActions, private readonly token: string | null) {}

  clear(): void {
    for (const card of this.cards.values()) card.end();
    this.cards.clear();
    this.element.replaceChildren();
  }

  show(state: RunState | undefined, colourOf: (agent: string) => string, chronicle: Chronicle, t_s: number, lagHolds: boolean, live: boolean): void {
    const agents = state?.agents ?? [];
    for (const agent of agents) {
      let card = this.cards.get(agent.name);
      if (!card) {
        this.cards.set(agent.name, (card = new Card(agent.name, this.actions, this.token)));
        this.element.append(card.element);
      }
      const standing = chronicle.standing(agent, state!);
      const span = chronicle.spanAt(agent.name, t_s);
      const shown = { agent, standing, lostFor_s: span?.state === "lost" ? Math.max(0, t_s - span.from_s) : undefined, lagHolds };
      card.show(shown, colourOf(agent.name), live);
      card.showPlots(chronicle, shown, t_s);
    }
    for (const [name, card] of this.cards) {
      if (agents.some((agent) => agent.name === name)) continue;
      card.end();
      card.element.remove();
      this.cards.delete(name);
    }
  }

  showTracks(tracks: ReadonlyMap<string, Tracks>): void { for (const [name, card] of this.cards) card.showTracks(tracks.get(name)); }
  redraw(): void { for (const card of this.cards.values()) if (card.open) card.redraw(); }

  mark(selected: string | undefined, followed: string | undefined, through: boolean): void {
    for (const [name, card] of this.cards) card.mark(name === selected, name === followed && !through, name === followed && through);
  }
}
