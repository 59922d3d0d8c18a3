// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A card for each camera: its state at a glance, figures and image plane when opened.
import type { Chronicle } from "../data/chronicle";
import type { AgentState, Tracks } from "../data/types";
import { button, count, digits, make, seconds, setText } from "./dom";
import { Plane } from "./plane";

export interface AgentActions {
  select(agent: string): void;
  follow(agent: string): void;
  through(agent: string): void;
  opened(agent: string, open: boolean): void;
  track(agent: string, track: number): void;
}

const STATE_TEXT = { tracking: "tracking", relative: "by its own motion", lost: "lost", none: "waiting" } as const;

class Card {
  readonly element: HTMLElement;
  readonly plane = new Plane();
  open = false;
  private readonly state = make("span", { class: "state" });
  private readonly why = make("p", { class: "why", hidden: "" });
  private readonly short = make("dl", { class: "short" });
  private readonly long = make("dl", { class: "long" });
  private readonly more: HTMLElement;
  private readonly follow: HTMLButtonElement;
  private readonly through: HTMLButtonElement;
  private readonly head: HTMLElement;
  private readonly values = new Map<string, HTMLElement>();

  constructor(readonly name: string, actions: AgentActions) {
    this.head = make("button", { type: "button", class: "head", "aria-expanded": "false", onclick: () => this.toggle(actions) },
      make("i", { class: "swatch" }), make("b", {}, name), this.state);
    this.follow = button("follow", `Follow ${name}`, () => actions.follow(name), "Follow");
    this.through = button("eye", `Look through ${name}`, () => actions.through(name), "Look through");
    const details = make("button", { type: "button", onclick: () => actions.select(name) }, "Life");
    const legend = make("p", { class: "key" }, ...["static", "moving", "uncertain", "unmapped"].map((text) => make("span", { class: text }, text)));
    this.more = make("div", { class: "more", hidden: "" }, this.long, this.plane.element, legend, make("div", { class: "buttons" }, this.follow, this.through, details));
    this.element = make("article", { class: "agent", "data-agent": name }, this.head, this.why, this.short, this.more);
    this.plane.onPick = (track) => actions.track(name, track);
  }

  show(agent: AgentState, colour: string, lostFor_s: number | undefined): void {
    const state = agent.alive ? agent.state : "gone";
    this.element.dataset["state"] = state;
    this.element.style.setProperty("--colour", colour);
    const text = agent.alive ? STATE_TEXT[agent.state] : "gone";
    setText(this.state, state === "lost" && lostFor_s !== undefined ? `lost for ${seconds(lostFor_s)}` : text);
    this.why.hidden = agent.why === "" || state === "tracking";
    setText(this.why, agent.why);
    this.figure(this.short, "rate", digits(agent.rate_hz, 1), "Hz", "Frames a second");
    this.figure(this.short, "frame", digits(agent.frame_ms, 1), "ms", "What the agent needs for a frame");
    this.figure(this.short, "bytes", `${digits(agent.kB_up_per_s, 0)} / ${digits(agent.kB_down_per_s, 0)}`, "kB/s ↑↓", "kB/s to the server and from it");
    const [lag, unit] = seconds(agent.lag_s).split(" ") as [string, string];
    this.figure(this.short, "lag", lag, `${unit} lag`, "From the capture to the map", agent.lag_s > 0.5 ? "warn" : "");
    if (this.open) this.showLong(agent);
  }

  showTracks(tracks: Tracks | undefined): void { if (this.open) this.plane.show(tracks); }

  mark(selected: boolean, followed: boolean, through: boolean): void {
    this.element.classList.toggle("selected", selected);
    this.follow.setAttribute("aria-pressed", String(followed));
    this.through.setAttribute("aria-pressed", String(through));
  }

  toggle(actions: AgentActions): void {
    this.open = !this.open;
    this.more.hidden = !this.open;
    this.head.setAttribute("aria-expanded", String(this.open));
    actions.opened(this.name, this.open);
    if (this.open) this.plane.draw();
  }

  private showLong(agent: AgentState): void {
    const clock = agent.clock_offset_ms, { account } = agent;
    this.figure(this.long, "tracks", count(agent.tracks), "followed", "Tracks");
    this.figure(this.long, "bound", count(agent.bound), "on the map", "Tracks with a point of the map", agent.bound < 15 ? "warn" : "");
    this.figure(this.long, "loss", digits(agent.lost_percent, 1), "% lost", "Frames that the network lost", agent.lost_percent > 2 ? "warn" : "");
    this.figure(this.long, "images", count(account?.captured ?? 0), "images", "That its source gave");
    this.figure(this.long, "posed", account ? digits(100 * account.tracked / Math.max(1, account.captured), 1) : "–", "% tracked", agent.losses || "All of its images are tracked");
    this.figure(this.long, "clock", clock === null ? "–" : `${clock < 0 ? "−" : "+"}${digits(Math.abs(clock), 1)}`, "ms clock", "Its clock against that of the server");
    this.figure(this.long, "map", agent.map === 0 ? "none" : String(agent.map), "map", "The map that it is in");
  }

  private figure(list: HTMLElement, key: string, value: string, unit: string, title: string, kind = ""): void {
    let element = this.values.get(key);
    if (!element) {
      element = make("div", { title, "data-key": key }, make("dd"), make("dt"));
      this.values.set(key, element);
      list.append(element);
    }
    element.className = kind;
    setText(element.firstElementChild as HTMLElement, value);
    setText(element.lastElementChild as HTMLElement, unit);
  }
}

export class Agents {
  readonly element = make("section", { class: "agents", "aria-label": "cameras" });
  private readonly cards = new Map<string, Card>();

  constructor(private readonly actions: AgentActions) {}

  clear(): void {
    this.cards.clear();
    this.element.replaceChildren();
  }

  show(agents: readonly AgentState[], colourOf: (agent: string) => string, chronicle: Chronicle, t_s: number): void {
    for (const agent of agents) {
      let card = this.cards.get(agent.name);
      if (!card) {
        this.cards.set(agent.name, (card = new Card(agent.name, this.actions)));
        this.element.append(card.element);
      }
      const span = chronicle.spanAt(agent.name, t_s);
      card.show(agent, colourOf(agent.name), span?.state === "lost" ? Math.max(0, t_s - span.from_s) : undefined);
    }
    for (const [name, card] of this.cards) {
      if (agents.some((agent) => agent.name === name)) continue;
      card.element.remove();
      this.cards.delete(name);
    }
  }

  showTracks(tracks: ReadonlyMap<string, Tracks>): void { for (const [name, card] of this.cards) card.showTracks(tracks.get(name)); }
  redraw(): void { for (const card of this.cards.values()) if (card.open) card.plane.draw(); }

  mark(selected: string | undefined, followed: string | undefined, through: boolean): void {
    for (const [name, card] of this.cards) card.mark(name === selected, name === followed && !through, name === followed && through);
  }
}
